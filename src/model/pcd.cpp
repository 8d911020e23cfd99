#include "model/pcd.h"

#include <sstream>
#include <stdexcept>

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

namespace recognition {
namespace {

int pclType(const PcdField& field) {
  using Field = pcl::PCLPointField;
  if (field.kind == 'F' && field.bytes == 4) return Field::FLOAT32;
  if (field.kind == 'U' && field.bytes == 4) return Field::UINT32;
  if (field.kind == 'U' && field.bytes == 2) return Field::UINT16;
  if (field.kind == 'I' && field.bytes == 1) return Field::INT8;
  throw std::invalid_argument("PCD field " + field.name + " is of an unknown type");
}

pcl::PCLPointCloud2 layoutOf(const std::vector<PcdField>& fields) {
  pcl::PCLPointCloud2 cloud;
  for (const PcdField& field : fields) {
    pcl::PCLPointField pcl_field;
    pcl_field.name = field.name;
    pcl_field.offset = cloud.point_step;
    pcl_field.datatype = static_cast<decltype(pcl_field.datatype)>(pclType(field));
    pcl_field.count = static_cast<decltype(pcl_field.count)>(field.count);
    cloud.fields.push_back(pcl_field);
    cloud.point_step += static_cast<decltype(cloud.point_step)>(field.bytes * field.count);
  }
  return cloud;
}

void requireLayout(const pcl::PCLPointCloud2& found, const pcl::PCLPointCloud2& wanted) {
  bool same = found.fields.size() == wanted.fields.size() && found.point_step == wanted.point_step;
  for (size_t i = 0; same && i < wanted.fields.size(); ++i)
    same = found.fields[i].name == wanted.fields[i].name && found.fields[i].offset == wanted.fields[i].offset &&
           found.fields[i].datatype == wanted.fields[i].datatype && found.fields[i].count == wanted.fields[i].count;
  if (!same) throw std::runtime_error("its fields are not those of a model");
}

/// Keeps PCL's own words off the screen: the errors here say what is wrong.
class Silence {
 public:
  Silence() { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }
  ~Silence() { pcl::console::setVerbosityLevel(before_); }

 private:
  const pcl::console::VERBOSITY_LEVEL before_ = pcl::console::getVerbosityLevel();
};

}  // namespace

size_t recordBytes(const std::vector<PcdField>& fields) { return layoutOf(fields).point_step; }

std::string encodePcd(const std::vector<PcdField>& fields, const std::string& records, int points) {
  pcl::PCLPointCloud2 cloud = layoutOf(fields);
  cloud.width = static_cast<decltype(cloud.width)>(points);
  cloud.height = 1;
  cloud.row_step = static_cast<decltype(cloud.row_step)>(records.size());
  cloud.is_dense = true;
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << pcl::PCDWriter().generateHeaderBinary(cloud, Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity())
      << "DATA binary\n"
      << records;
  return out.str();
}

std::string decodePcd(const std::string& bytes, const std::vector<PcdField>& fields) {
  const Silence silence;
  pcl::PCLPointCloud2 cloud;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, data_type = 0;
  unsigned data_begin = 0;
  std::istringstream in(bytes);
  if (pcl::PCDReader().readHeader(in, cloud, origin, orientation, version, data_type, data_begin) != 0)
    throw std::runtime_error("has no valid PCD header");
  if (data_type != 1) throw std::runtime_error("is no binary PCD file");
  requireLayout(cloud, layoutOf(fields));
  const std::uint64_t size = std::uint64_t(cloud.width) * cloud.height * cloud.point_step;
  if (data_begin > bytes.size() || bytes.size() - data_begin != size)
    throw std::runtime_error("its size does not fit its header");
  return bytes.substr(data_begin);
}

}  // namespace recognition
