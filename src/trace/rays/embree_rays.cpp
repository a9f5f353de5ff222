// SPDX-License-Identifier: Apache-2.0
// Traces batches of rays, one by one or in packets.
#include <algorithm>
#include <limits>

#include "trace/rays/embree_types.hpp"

namespace gazetrace {
namespace {

// The value of tfar that the library sets for occluded rays. A ray to a light that is closer than rounding errors also
// has a negative tfar, but is not occluded.
constexpr float kOccluded = -std::numeric_limits<float>::infinity();

}  // namespace

int RayScene::intersect(const RayBatch& rays, int count, RayShape shape, HitBatch& hits, bool of_camera) const {
  return impl_->timed ? impl_->intersect<true>(rays, count, shape, hits, of_camera)
                      : impl_->intersect<false>(rays, count, shape, hits, of_camera);
}

template <bool kTimed>
int RayScene::Impl::intersect(const RayBatch& rays, int count, RayShape shape, HitBatch& hits, bool of_camera) const {
  Query query(alpha, rays.alpha_key.data, shape == RayShape::coherent_packet ? kCoherent : kIncoherent, of_camera);
  int refused = 0;
  if (shape == RayShape::single) {
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!acceptable(rays, k)) {
        ++refused;
        hits.geometry[k] = kRejected;
        continue;
      }
      RTCRayHit ray;
      fill_single<kTimed>(rays, k, ray.ray);
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      query.intersect(top, ray);
      hits.t[k] = ray.ray.tfar;
      hits.u[k] = ray.hit.u;
      hits.v[k] = ray.hit.v;
      hits.primitive[k] = ray.hit.primID;
      hits.geometry[k] = ray.hit.geomID;
      hits.instance[k] = ray.hit.instID[0];
    }
    return refused;
  }
  for (int first = 0; first < count; first += kPacket) {
    const auto base = static_cast<std::size_t>(first);
    const int lanes = std::min(kPacket, count - first);
    alignas(64) int valid[kPacket];
    RTCRayHit16 packet;
    refused += fill_packet<kTimed>(rays, base, lanes, packet.ray, valid);
    for (int lane = 0; lane < kPacket; ++lane) {
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.primID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.u[lane] = 0;
      packet.hit.v[lane] = 0;
    }
    query.intersect(top, valid, packet);
    for (int lane = 0; lane < kPacket; ++lane) {
      const std::size_t k = base + static_cast<std::size_t>(lane);
      hits.t[k] = packet.ray.tfar[lane];
      hits.u[k] = packet.hit.u[lane];
      hits.v[k] = packet.hit.v[lane];
      hits.primitive[k] = packet.hit.primID[lane];
      hits.geometry[k] = valid[lane] != 0 ? packet.hit.geomID[lane] : kRejected;
      hits.instance[k] = packet.hit.instID[0][lane];
    }
  }
  return refused;
}

int RayScene::occluded(const RayBatch& rays, int count, RayShape shape, std::uint8_t* occluded) const {
  return impl_->timed ? impl_->occluded<true>(rays, count, shape, occluded)
                      : impl_->occluded<false>(rays, count, shape, occluded);
}

template <bool kTimed>
int RayScene::Impl::occluded(const RayBatch& rays, int count, RayShape shape, std::uint8_t* occluded) const {
  Query query(alpha, rays.alpha_key.data, shape == RayShape::coherent_packet ? kCoherent : kIncoherent);
  int refused = 0;
  if (shape == RayShape::single) {
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!acceptable(rays, k)) {
        ++refused;
        occluded[k] = 2;
        continue;
      }
      RTCRay ray;
      fill_single<kTimed>(rays, k, ray);
      query.occluded(top, ray);
      occluded[k] = ray.tfar == kOccluded ? 1 : 0;
    }
    return refused;
  }
  for (int first = 0; first < count; first += kPacket) {
    const auto base = static_cast<std::size_t>(first);
    const int lanes = std::min(kPacket, count - first);
    alignas(64) int valid[kPacket];
    RTCRay16 packet;
    refused += fill_packet<kTimed>(rays, base, lanes, packet, valid);
    query.occluded(top, valid, packet);
    for (int lane = 0; lane < lanes; ++lane) {
      occluded[base + static_cast<std::size_t>(lane)] =
          valid[lane] == 0 ? std::uint8_t{2} : static_cast<std::uint8_t>(packet.tfar[lane] == kOccluded ? 1 : 0);
    }
  }
  return refused;
}

}  // namespace gazetrace
