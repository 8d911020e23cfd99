#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "rgbd_recognition/core/pose.h"

namespace recognition {

/// A detection as the results files name it.
struct ResultRow {
  double stamp = 0.0;  ///< seconds
  int run = 0;         ///< scene
  int frame = 0;
  int object_id = 0;   ///< dID
  int instance = 0;    ///< oID: counts instances of one object in one frame
  std::string object;  ///< its model's name
  double confidence = 0.0;
  double seconds = 0.0;  ///< spent on the frame
  Pose camera_from_object = Pose::Identity();
};

/// The challenge's CSV: header Ts,Run,Frame,dID,oID,R11..R33,Tx,Ty,Tz (metres, camera optical frame).
void writeChallengeCsv(std::ostream& out, const std::vector<ResultRow>& rows);
/// The same in parts, with the object's name in a last column, Object.
void writeNamedHeader(std::ostream& out);
void writeNamedRows(std::ostream& out, const std::vector<ResultRow>& rows);
/// Reads either back; throws std::runtime_error with line number and reason.
std::vector<ResultRow> readChallengeCsv(std::istream& in);

/// BOP's results CSV (bop19): scene_id,im_id,obj_id,score,R,t,time (R row by row, t in millimetres).
void writeBopCsv(std::ostream& out, const std::vector<ResultRow>& rows);

}  // namespace recognition
