// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <array>
#include <cstdint>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <string>
#include <vector>

/// The ROS 2 types that Cairn speaks, written down a second time for another DDS implementation:
/// nothing here comes from idl/.
namespace fast {

struct Header {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::string frame_id;
};
struct Pose {
  double x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 1;
};
struct LaserScan {
  static constexpr const char* kType = "sensor_msgs::msg::dds_::LaserScan_";
  Header header;
  float angle_min = 0, angle_max = 0, angle_increment = 0, time_increment = 0, scan_time = 0,
        range_min = 0, range_max = 0;
  std::vector<float> ranges, intensities;
};
struct Odometry {
  static constexpr const char* kType = "nav_msgs::msg::dds_::Odometry_";
  Header header;
  std::string child_frame_id;
  Pose pose;
  std::array<double, 36> pose_covariance{};
  std::array<double, 6> twist{};
  std::array<double, 36> twist_covariance{};
};
struct TransformStamped {
  Header header;
  std::string child_frame_id;
  Pose transform;
};
struct TFMessage {
  static constexpr const char* kType = "tf2_msgs::msg::dds_::TFMessage_";
  std::vector<TransformStamped> transforms;
};
struct PoseStamped {
  Header header;
  Pose pose;
};
struct Path {
  static constexpr const char* kType = "nav_msgs::msg::dds_::Path_";
  Header header;
  std::vector<PoseStamped> poses;
};
struct OccupancyGrid {
  static constexpr const char* kType = "nav_msgs::msg::dds_::OccupancyGrid_";
  Header header;
  std::int32_t load_sec = 0;
  std::uint32_t load_nanosec = 0;
  float resolution = 0;
  std::uint32_t width = 0, height = 0;
  Pose origin;
  std::vector<std::uint8_t> data;  ///< int8 on the wire
};
struct OccupancyGridUpdate {
  static constexpr const char* kType = "map_msgs::msg::dds_::OccupancyGridUpdate_";
  Header header;
  std::int32_t x = 0, y = 0;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> data;
};

// One list of fields serves both directions.
template <class Io>
void fields(Io& io, Header& h) {
  io(h.sec), io(h.nanosec), io(h.frame_id);
}
template <class Io>
void fields(Io& io, Pose& p) {
  for (double* number : {&p.x, &p.y, &p.z, &p.qx, &p.qy, &p.qz, &p.qw}) io(*number);
}
template <class Io>
void fields(Io& io, LaserScan& s) {
  fields(io, s.header);
  for (float* number : {&s.angle_min, &s.angle_max, &s.angle_increment, &s.time_increment,
                        &s.scan_time, &s.range_min, &s.range_max})
    io(*number);
  io(s.ranges), io(s.intensities);
}
template <class Io>
void fields(Io& io, Odometry& o) {
  fields(io, o.header);
  io(o.child_frame_id);
  fields(io, o.pose);
  io(o.pose_covariance), io(o.twist), io(o.twist_covariance);
}
template <class Io>
void fields(Io& io, TransformStamped& t) {
  fields(io, t.header);
  io(t.child_frame_id);
  fields(io, t.transform);
}
template <class Io>
void fields(Io& io, TFMessage& m) {
  io.sequence(m.transforms);
}
template <class Io>
void fields(Io& io, PoseStamped& p) {
  fields(io, p.header), fields(io, p.pose);
}
template <class Io>
void fields(Io& io, Path& p) {
  fields(io, p.header);
  io.sequence(p.poses);
}
template <class Io>
void fields(Io& io, OccupancyGrid& g) {
  fields(io, g.header);
  io(g.load_sec), io(g.load_nanosec), io(g.resolution), io(g.width), io(g.height);
  fields(io, g.origin);
  io(g.data);
}
template <class Io>
void fields(Io& io, OccupancyGridUpdate& u) {
  fields(io, u.header);
  io(u.x), io(u.y), io(u.width), io(u.height), io(u.data);
}

using eprosima::fastcdr::Cdr;

struct Out {
  Cdr& cdr;
  template <class T>
  void operator()(const T& value) {
    cdr << value;
  }
  template <class T>
  void sequence(std::vector<T>& all) {
    cdr << static_cast<std::uint32_t>(all.size());
    for (T& one : all) fields(*this, one);
  }
};
struct In {
  Cdr& cdr;
  template <class T>
  void operator()(T& value) {
    cdr >> value;
  }
  template <class T>
  void sequence(std::vector<T>& all) {
    std::uint32_t count = 0;
    cdr >> count;
    all.assign(count, {});
    for (T& one : all) fields(*this, one);
  }
};

/// Fast DDS's view of a type, without its code generator.
template <class T>
class CdrType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  CdrType() {
    setName(T::kType);
    m_typeSize = 1024;  // grows
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, Payload* payload) override {
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    payload->encapsulation = CDR_LE;
    cdr.serialize_encapsulation();
    Out out{cdr};
    fields(out, *static_cast<T*>(data));
    payload->length = static_cast<std::uint32_t>(cdr.getSerializedDataLength());
    return true;
  }
  bool deserialize(Payload* payload, void* data) override try {
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->length);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    In in{cdr};
    fields(in, *static_cast<T*>(data));
    return true;
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return false;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] {
      eprosima::fastcdr::FastBuffer buffer;
      Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
      cdr.serialize_encapsulation();
      Out out{cdr};
      fields(out, *static_cast<T*>(data));
      return static_cast<std::uint32_t>(cdr.getSerializedDataLength());
    };
  }
  void* createData() override { return new T(); }
  void deleteData(void* data) override { delete static_cast<T*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace fast
