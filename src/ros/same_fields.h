#pragma once

#include <vector>

#include <ros/message_traits.h>
#include <ros/serialization.h>

namespace recognition {

/// A message with the fields of another one whose definition is the same, as those of a service and of its action are.
template <typename To, typename From>
To withFieldsOf(const From& from) {
  using ToSum = ros::message_traits::MD5Sum<To>;
  using FromSum = ros::message_traits::MD5Sum<From>;
  static_assert(ToSum::static_value1 == FromSum::static_value1 && ToSum::static_value2 == FromSum::static_value2,
                "the definitions of the two messages differ");
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(from));
  ros::serialization::OStream out(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(out, from);
  To to;
  ros::serialization::IStream in(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::deserialize(in, to);
  return to;
}

}  // namespace recognition
