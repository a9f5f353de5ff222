// SPDX-License-Identifier: Apache-2.0
#include "trace/guiding/guiding_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

constexpr float kSphere = static_cast<float>(4 * kPi);

// Cells of fewer records are not made. A table counts as many records of its own as of the cell that it is in where it
// has kPrior of them. Both were found by the error of Sponza's hall and San Miguel's court.
constexpr std::size_t kLeastRecords = 256;
constexpr double kPrior = 1000;

constexpr std::array kShares{0.0, 0.3, 0.6, 0.9};
// A table that is expected to save less than this part of the variance is left out, since reading it takes time.
constexpr double kLeastGain = 0.05;
// In a glimpse of a few thousand paths, the best cell of a scene of 10,000 lamps saved 0.06 of the variance, that of
// Sponza's hall, of San Miguel's court and of Lost Empire at least 0.17.
constexpr double kLeastPromise = 0.1;

using Bins = std::array<double, kDirectionBins>;

std::size_t interval_of(const float* ends, std::size_t count, float u) {
  std::size_t i = 0;
  while (i + 1 < count && !(u < ends[i])) {
    ++i;
  }
  return i;
}

float part_of(float low, float high, float u) {
  return high > low ? std::clamp((u - low) / (high - low), 0.0F, 0x1.fffffep-1F) : 0.5F;
}

struct Entry {
  std::uint64_t key = 0;  // facing, then the bits of the three coordinates interleaved, coarse ones first
  std::uint32_t record = 0;
  std::uint16_t bin = 0;
  float light = 0;  // radiance times cosine
  float pdf = 0, bsdf_pdf = 0;
  std::uint8_t half = 0;
};

DirectionTable table_of(const Bins& density) {
  DirectionTable table;
  double below = 0;
  for (std::size_t band = 0; band < kBands; ++band) {
    double total = 0;
    for (std::size_t sector = 0; sector < kSectors; ++sector) {
      total += density[band * kSectors + sector];
    }
    double sum = 0;
    for (std::size_t sector = 0; sector < kSectors; ++sector) {
      sum += density[band * kSectors + sector];
      table.sector[band][sector] = static_cast<float>(sum / total);
    }
    table.sector[band].back() = 1;
    below += total;
    table.band[band] = static_cast<float>(below);
  }
  table.band.back() = 1;
  return table;
}

// A distribution that adds up to 1: the roots of the sums of squares, drawn towards that of the larger cell.
Bins drawn_towards(const Bins& squares, double records, const Bins& larger) {
  Bins own;
  double total = 0;
  for (std::size_t bin = 0; bin < kDirectionBins; ++bin) {
    own[bin] = std::sqrt(squares[bin]);
    total += own[bin];
  }
  const double weight = total > 0 ? records / (records + kPrior) : 0;
  for (std::size_t bin = 0; bin < kDirectionBins; ++bin) {
    own[bin] = (total > 0 ? weight * own[bin] / total : 0) + (1 - weight) * larger[bin];
  }
  return own;
}

}  // namespace

DirectionTable::Sample DirectionTable::sample(const Vec2f& u) const noexcept {
  DirectionBin bin;
  bin.band = interval_of(band.data(), kBands, u.y);
  const float low = bin.band > 0 ? band[bin.band - 1] : 0.0F;
  const std::array<float, kSectors>& sectors = sector[bin.band];
  bin.sector = interval_of(sectors.data(), kSectors, u.x);
  const float left = bin.sector > 0 ? sectors[bin.sector - 1] : 0.0F;
  const Vec3f direction =
      direction_in(bin, {part_of(left, sectors[bin.sector], u.x), part_of(low, band[bin.band], u.y)});
  // On the edge of a bin rounding may put the direction into its neighbour, whose density then counts, as it does where
  // another way of sampling finds this direction.
  return {direction, pdf(direction)};
}

float DirectionTable::pdf(const Vec3f& direction) const noexcept {
  const DirectionBin bin = bin_of(direction);
  const float low = bin.band > 0 ? band[bin.band - 1] : 0.0F;
  const float left = bin.sector > 0 ? sector[bin.band][bin.sector - 1] : 0.0F;
  return (band[bin.band] - low) * (sector[bin.band][bin.sector] - left) *
         (static_cast<float>(kDirectionBins) / kSphere);
}

struct GuidingField::Branch {
  std::vector<Children> nodes;
  std::vector<DirectionTable> tables;
  std::vector<float> shares;
  double promise = 0;  // the largest part of the variance that a table alone saves
};

// Makes the cells of one facing from its entries, which are in the order of their keys: those of a cell follow each
// other.
class GuidingField::BranchBuilder {
 public:
  Branch build(std::span<const Entry> entries) {
    Larger even;
    for (Bins& bins : even.distribution) {
      bins.fill(1.0 / kDirectionBins);
    }
    even.left.fill(1.0);
    add(entries, 0, even);
    return std::move(branch_);
  }

 private:
  struct Larger {
    std::array<Bins, 3> distribution;           // from the paths of even numbers, of odd ones, and from all
    std::array<double, kShares.size()> left{};  // for each share, the part of the variance that it leaves
  };

  std::int32_t add(std::span<const Entry> entries, unsigned depth, const Larger& larger) {
    if (entries.size() < kLeastRecords) {
      return -1;
    }
    const auto index = static_cast<std::int32_t>(branch_.nodes.size());
    branch_.nodes.emplace_back().fill(-1);
    const Larger own = train(entries, larger);
    branch_.tables.push_back(table_of(own.distribution[2]));
    const auto best = std::min_element(own.left.begin(), own.left.end());
    const bool pays = *best < 1 - kLeastGain;
    branch_.shares.push_back(pays ? static_cast<float>(kShares[static_cast<std::size_t>(best - own.left.begin())])
                                  : 0.0F);
    if (depth < kDepth) {
      const unsigned shift = 3 * (kDepth - 1 - depth);
      for (std::size_t begin = 0; begin < entries.size();) {
        const std::uint64_t octant = (entries[begin].key >> shift) & 7U;
        std::size_t end = begin;
        while (end < entries.size() && ((entries[end].key >> shift) & 7U) == octant) {
          ++end;
        }
        const std::int32_t child = add(entries.subspan(begin, end - begin), depth + 1, own);
        branch_.nodes[static_cast<std::size_t>(index)][octant] = child;
        begin = end;
      }
    }
    return index;
  }

  Larger train(std::span<const Entry> entries, const Larger& larger) {
    std::array<Bins, 3> squares{};
    std::array<double, 3> count{};
    for (const Entry& entry : entries) {
      const double square = static_cast<double>(entry.light) * entry.light / entry.pdf;
      squares[entry.half][entry.bin] += square;
      squares[2][entry.bin] += square;
      ++count[entry.half];
      ++count[2];
    }
    Larger own;
    for (std::size_t i = 0; i < 3; ++i) {
      own.distribution[i] = drawn_towards(squares[i], count[i], larger.distribution[i]);
    }
    // The second moment of light / density, for a density that has `share` of the other half's table.
    std::array<double, kShares.size()> moment{};
    for (const Entry& entry : entries) {
      const double table = own.distribution[1U - entry.half][entry.bin] * (kDirectionBins / (4 * kPi));
      const double square = static_cast<double>(entry.light) * entry.light / entry.pdf;
      for (std::size_t i = 0; i < kShares.size(); ++i) {
        moment[i] += square / ((1 - kShares[i]) * static_cast<double>(entry.bsdf_pdf) + kShares[i] * table);
      }
    }
    if (moment[0] > 0) {
      branch_.promise = std::max(branch_.promise, 1.0 - *std::min_element(moment.begin(), moment.end()) / moment[0]);
    }
    const double weight = count[2] / (count[2] + kPrior);
    for (std::size_t i = 0; i < kShares.size(); ++i) {
      own.left[i] = weight * (moment[0] > 0 ? moment[i] / moment[0] : 1.0) + (1 - weight) * larger.left[i];
    }
    return own;
  }

  Branch branch_;
};

GuidingField::Place GuidingField::place_of(const Vec3f& position) const noexcept {
  constexpr float kMost = static_cast<float>((1U << kDepth) - 1U);
  const auto step = [&](float x, float origin) {
    const float at = (x - origin) * steps_per_m_;
    return static_cast<std::uint32_t>(at > 0 ? std::min(at, kMost) : 0.0F);
  };
  return {{step(position.x, origin_.x), step(position.y, origin_.y), step(position.z, origin_.z)}};
}

std::size_t GuidingField::facing_of(const Vec3f& normal) noexcept {
  const auto third = [](float x) { return static_cast<std::size_t>(x > 0.5F ? 2 : (x < -0.5F ? 0 : 1)); };
  return (third(normal.x) * 3 + third(normal.y)) * 3 + third(normal.z);
}

GuidingField::GuidingField(const std::vector<TrainingRecord>& records, int threads) {
  roots_.fill(-1);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Vec3f low{kInfinity, kInfinity, kInfinity};
  Vec3f high{-kInfinity, -kInfinity, -kInfinity};
  for (const TrainingRecord& record : records) {
    const Vec3f& p = record.position;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const float side = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  if (!std::isfinite(side)) {
    return;
  }
  origin_ = low;
  steps_per_m_ = side > 0 ? static_cast<float>(1U << kDepth) / side : 0.0F;

  std::vector<Entry> entries;
  entries.reserve(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const TrainingRecord& record = records[i];
    const float light = record.radiance * std::max(0.0F, dot(record.normal, record.direction));
    if (!(record.pdf > 0) || !std::isfinite(record.pdf) || !(record.bsdf_pdf > 0) || !std::isfinite(record.bsdf_pdf) ||
        !(light >= 0) || !std::isfinite(light)) {
      continue;
    }
    std::uint64_t key = facing_of(record.normal);
    const Place place = place_of(record.position);
    for (unsigned bit = kDepth; bit-- > 0;) {
      for (const std::uint32_t at : place.at) {
        key = (key << 1U) | ((at >> bit) & 1U);
      }
    }
    entries.push_back({key, static_cast<std::uint32_t>(i), static_cast<std::uint16_t>(bin_of(record.direction).index()),
                       light, record.pdf, record.bsdf_pdf, static_cast<std::uint8_t>(record.path & 1U)});
  }
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.record < b.record; });

  std::array<std::span<const Entry>, kFacings> of_facing;
  for (std::size_t begin = 0; begin < entries.size();) {
    const auto facing = static_cast<std::size_t>(entries[begin].key >> (3U * kDepth));
    std::size_t end = begin;
    while (end < entries.size() && entries[end].key >> (3U * kDepth) == facing) {
      ++end;
    }
    of_facing[facing] = std::span<const Entry>(entries).subspan(begin, end - begin);
    begin = end;
  }
  std::array<Branch, kFacings> branches;
  parallel_for(kFacings, threads, [&](std::size_t i) { branches[i] = BranchBuilder().build(of_facing[i]); });

  for (std::size_t i = 0; i < kFacings; ++i) {
    const auto first = static_cast<std::int32_t>(nodes_.size());
    roots_[i] = branches[i].nodes.empty() ? -1 : first;
    for (Children& node : branches[i].nodes) {
      for (std::int32_t& child : node) {
        child += child < 0 ? 0 : first;
      }
    }
    nodes_.insert(nodes_.end(), branches[i].nodes.begin(), branches[i].nodes.end());
    tables_.insert(tables_.end(), branches[i].tables.begin(), branches[i].tables.end());
    shares_.insert(shares_.end(), branches[i].shares.begin(), branches[i].shares.end());
    promises_ = promises_ || branches[i].promise > kLeastPromise;
  }
  pays_ = std::any_of(shares_.begin(), shares_.end(), [](float share) { return share > 0; });
}

std::int32_t GuidingField::cell_at(const Vec3f& position, const Vec3f& normal) const noexcept {
  const Place place = place_of(position);
  std::int32_t cell = roots_[facing_of(normal)];
  if (cell < 0) {
    return cell;
  }
  for (unsigned bit = kDepth; bit-- > 0;) {
    const std::size_t octant =
        (((place.at[0] >> bit) & 1U) << 2U) | (((place.at[1] >> bit) & 1U) << 1U) | ((place.at[2] >> bit) & 1U);
    const std::int32_t child = nodes_[static_cast<std::size_t>(cell)][octant];
    if (child < 0) {
      break;
    }
    cell = child;
  }
  return cell;
}

std::size_t GuidingField::bytes() const noexcept {
  return nodes_.size() * (sizeof(Children) + sizeof(DirectionTable) + sizeof(float));
}

}  // namespace gazetrace
