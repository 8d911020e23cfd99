#include "evaluation/result_files.h"

#include <cmath>
#include <istream>
#include <limits>
#include <ostream>
#include <sstream>
#include <stdexcept>

namespace recognition {
namespace {

constexpr const char* kHeader = "Ts,Run,Frame,dID,oID,R11,R12,R13,R21,R22,R23,R31,R32,R33,Tx,Ty,Tz";
constexpr size_t kColumns = 17;

/// The numbers of a line; a cell behind them is the object's name.
std::vector<double> numbersOf(const std::string& line, int number, std::string* name) {
  std::vector<double> values;
  std::istringstream cells(line);
  for (std::string cell; std::getline(cells, cell, ',');) {
    if (values.size() == kColumns && name->empty()) {
      *name = cell.substr(0, cell.find('\r'));
      continue;
    }
    try {
      size_t used = 0;
      values.push_back(std::stod(cell, &used));
      if (cell.find_first_not_of(" \r", used) != std::string::npos) throw std::invalid_argument(cell);
    } catch (const std::exception&) {
      throw std::runtime_error("line " + std::to_string(number) + ": '" + cell + "' is no number");
    }
  }
  if (values.size() != kColumns)
    throw std::runtime_error("line " + std::to_string(number) + ": " + std::to_string(values.size()) +
                             " columns, not 17");
  return values;
}

int wholeNumber(double value, int line) {
  if (!(std::abs(value) <= std::numeric_limits<int>::max()))
    throw std::runtime_error("line " + std::to_string(line) + ": " + std::to_string(value) + " is no run, frame or id");
  return static_cast<int>(value);
}

void writeNumbers(std::ostream& out, const ResultRow& row) {
  out.precision(17);
  out << row.stamp << ',' << row.run << ',' << row.frame << ',' << row.object_id << ',' << row.instance;
  out.precision(9);
  for (int i = 0; i < 9; ++i) out << ',' << row.camera_from_object.linear()(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) out << ',' << row.camera_from_object.translation()(i);
}

}  // namespace

void writeChallengeCsv(std::ostream& out, const std::vector<ResultRow>& rows) {
  out << kHeader << "\n";
  for (const ResultRow& row : rows) {
    writeNumbers(out, row);
    out << "\n";
  }
}

void writeNamedHeader(std::ostream& out) { out << kHeader << ",Object\n"; }

void writeNamedRows(std::ostream& out, const std::vector<ResultRow>& rows) {
  for (const ResultRow& row : rows) {
    writeNumbers(out, row);
    out << ',' << row.object << "\n";
  }
}

std::vector<ResultRow> readChallengeCsv(std::istream& in) {
  std::vector<ResultRow> rows;
  std::string line;
  if (!std::getline(in, line) || line.rfind(kHeader, 0) != 0)
    throw std::runtime_error(std::string("line 1: header is not ") + kHeader);
  for (int number = 2; std::getline(in, line); ++number) {
    if (line.empty()) continue;
    ResultRow row;
    const std::vector<double> v = numbersOf(line, number, &row.object);
    row.stamp = v[0];
    row.run = wholeNumber(v[1], number);
    row.frame = wholeNumber(v[2], number);
    row.object_id = wholeNumber(v[3], number);
    row.instance = wholeNumber(v[4], number);
    for (int i = 0; i < 9; ++i) row.camera_from_object.linear()(i / 3, i % 3) = v[static_cast<size_t>(5 + i)];
    for (int i = 0; i < 3; ++i) row.camera_from_object.translation()(i) = v[static_cast<size_t>(14 + i)];
    rows.push_back(row);
  }
  return rows;
}

void writeBopCsv(std::ostream& out, const std::vector<ResultRow>& rows) {
  out << "scene_id,im_id,obj_id,score,R,t,time\n";
  out.precision(9);
  for (const ResultRow& row : rows) {
    out << row.run << ',' << row.frame << ',' << row.object_id << ',' << row.confidence << ',';
    for (int i = 0; i < 9; ++i) out << (i ? " " : "") << row.camera_from_object.linear()(i / 3, i % 3);
    out << ',';
    for (int i = 0; i < 3; ++i) out << (i ? " " : "") << 1000.0 * row.camera_from_object.translation()(i);
    out << ',' << row.seconds << "\n";
  }
}

}  // namespace recognition
