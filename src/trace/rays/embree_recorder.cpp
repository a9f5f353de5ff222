// SPDX-License-Identifier: Apache-2.0
// Keeps rays in the library's own layout, to trace them again.
#include <algorithm>
#include <array>
#include <utility>

#include "trace/rays/embree_types.hpp"

namespace gazetrace {
namespace {

// Of a packet's first `count` lanes, as far as it has them, those for which `holds`.
template <class Holds>
std::uint64_t lanes_where(int count, const Holds& holds) {
  std::uint64_t found = 0;
  for (int lane = 0; lane < std::min(kPacket, count); ++lane) {
    found += holds(lane) ? 1 : 0;
  }
  return found;
}

}  // namespace

struct RayRecorder::Impl {
  struct Call {
    RayShape shape;
    bool occlusion;
    int count;
    std::size_t first;  // index into singles or packets
    std::vector<std::uint32_t> keys;
  };
  std::vector<Call> calls;
  std::vector<RTCRay> singles;
  std::vector<RTCRay16> packets;
};

RayRecorder::RayRecorder() : impl_(std::make_unique<Impl>()) {}
RayRecorder::~RayRecorder() = default;

void RayRecorder::record(const RayBatch& rays, int count, RayShape shape, bool occlusion) {
  Impl::Call call{shape,
                  occlusion,
                  count,
                  shape == RayShape::single ? impl_->singles.size() : impl_->packets.size(),
                  {rays.alpha_key.data, rays.alpha_key.data + count}};
  if (shape == RayShape::single) {
    for (int i = 0; i < count; ++i) {
      fill_single<false>(rays, static_cast<std::size_t>(i), impl_->singles.emplace_back());
    }
  } else {
    for (int first = 0; first < count; first += kPacket) {
      std::array<int, kPacket> valid{};
      fill_packet<false>(rays, static_cast<std::size_t>(first), std::min(kPacket, count - first),
                         impl_->packets.emplace_back(), valid.data());
    }
  }
  impl_->calls.push_back(std::move(call));
}

std::uint64_t RayRecorder::replay(const RayScene& scene) const {
  std::uint64_t found = 0;
  RTCScene top = scene.impl_->top;
  for (const Impl::Call& call : impl_->calls) {
    Query query(scene.impl_->alpha, call.keys.data(),
                call.shape == RayShape::coherent_packet ? kCoherent : kIncoherent);
    if (call.shape == RayShape::single) {
      for (int i = 0; i < call.count; ++i) {
        const RTCRay& source = impl_->singles[call.first + static_cast<std::size_t>(i)];
        if (call.occlusion) {
          RTCRay ray = source;
          query.occluded(top, ray);
          found += ray.tfar < 0 ? 1 : 0;
        } else {
          RTCRayHit ray;
          ray.ray = source;
          ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
          ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
          query.intersect(top, ray);
          found += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
        }
      }
      continue;
    }
    for (int first = 0; first < call.count; first += kPacket) {
      const RTCRay16& source = impl_->packets[call.first + static_cast<std::size_t>(first / kPacket)];
      alignas(64) int valid[kPacket];
      for (int lane = 0; lane < kPacket; ++lane) {
        valid[lane] = first + lane < call.count ? -1 : 0;
      }
      if (call.occlusion) {
        RTCRay16 packet = source;
        query.occluded(top, valid, packet);
        found += lanes_where(call.count - first, [&](int lane) { return packet.tfar[lane] < 0; });
      } else {
        RTCRayHit16 packet;
        packet.ray = source;
        for (int lane = 0; lane < kPacket; ++lane) {
          packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
          packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        }
        query.intersect(top, valid, packet);
        found += lanes_where(call.count - first,
                             [&](int lane) { return packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID; });
      }
    }
  }
  return found;
}

std::uint64_t RayRecorder::size() const {
  std::uint64_t count = 0;
  for (const Impl::Call& call : impl_->calls) {
    count += static_cast<std::uint64_t>(call.count);
  }
  return count;
}

}  // namespace gazetrace
