#include "lights/light_regions.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

namespace castray {

namespace {

constexpr std::size_t nodes = most_light_cut;
using ByNode = std::array<double, nodes>;

constexpr int deepest = 12;
constexpr std::size_t smallest_region = 24;  // trials

template <class Use>
void for_each_bit(std::uint32_t bits, Use use) {
  for (; bits; bits &= bits - 1) use(static_cast<std::size_t>(std::countr_zero(bits)));
}

/// Squared deviations of `seen` ones and of zeros from their mean.
double spread(double tested, double seen) { return tested > 0 ? seen * (1 - seen / tested) : 0; }

/// How often each node was looked for, and seen.
struct Counts {
  ByNode tested{}, seen{};
  double spread = 0;  ///< sum over nodes

  /// Adds a trial, or takes it away.
  void change(const LightTrial& trial, double by) {
    for_each_bit(trial.tested, [&](std::size_t i) {
      spread -= castray::spread(tested[i], seen[i]);
      tested[i] += by;
      seen[i] += trial.seen >> i & 1 ? by : 0;
      spread += castray::spread(tested[i], seen[i]);
    });
  }
  /// What a plane anywhere takes off the spread by chance: one degree of freedom a node.
  double chance() const {
    double sum = 0;
    for (std::size_t i = 0; i < nodes; ++i)
      if (tested[i] > 0) sum += castray::spread(tested[i], seen[i]) / tested[i];
    return sum;
  }
};

using Trials = std::span<const LightTrial*>;

struct Split {
  int axis = 0;
  float plane = 0;
  double gain = 0;  ///< spread that it takes away
};

/// Sorts the trials along the axis.
Split best_on_axis(Trials trials, const Counts& all, int axis) {
  std::ranges::sort(trials, {}, [axis](const LightTrial* t) { return std::pair(t->place[axis], t); });
  Split best{axis, 0, 0};
  Counts below, above = all;
  for (std::size_t i = 0; i + smallest_region < trials.size(); ++i) {
    below.change(*trials[i], 1);
    above.change(*trials[i], -1);
    const float last = trials[i]->place[axis], next = trials[i + 1]->place[axis];
    const double gain = all.spread - below.spread - above.spread;
    if (i + 1 < smallest_region || !(last < next) || gain <= best.gain) continue;
    const float middle = last + (next - last) / 2;
    best = {axis, last < middle ? middle : next, gain};
  }
  return best;
}

Split best_split(Trials trials, const Counts& all) {
  Split best;
  for (int axis = 0; axis < 3; ++axis)
    if (const Split split = best_on_axis(trials, all, axis); split.gain > best.gain) best = split;
  return best;
}

/// A split is worth it if chance hardly explains it and it explains something.
bool is_worth_it(const Split& split, const Counts& all) {
  constexpr double times = 3, more = 3, least = 0.002;
  const double tests = std::accumulate(all.tested.begin(), all.tested.end(), 0.0);
  return split.gain > times * all.chance() + more && split.gain > least * tests;
}

/// Of each node, the share of its points that is seen; the one of the region around where it is not known.
ByNode shares(const Counts& counts, const ByNode& around) {
  constexpr double enough = 8;
  ByNode share = around;
  for (std::size_t i = 0; i < nodes; ++i)
    if (counts.tested[i] >= enough) share[i] = counts.seen[i] / counts.tested[i];
  return share;
}

/// The probabilities with which a light sample of a place chooses the nodes, bounds taken to be `potential`.
ByNode probabilities(const LightTrial& trial, const float* seen) {
  double all = 0, learned = 0;
  for (std::size_t i = 0; i < nodes; ++i) {
    all += double{trial.potential[i]};
    learned += double{trial.potential[i]} * seen[i];
  }
  ByNode p{};
  if (!(all > 0)) return p;
  const double share = learned > 0 ? double{learned_share} : 0;
  for (std::size_t i = 0; i < nodes; ++i)
    p[i] = trial.potential[i] * ((1 - share) / all + (learned > 0 ? share * seen[i] / learned : 0));
  return p;
}

/// What light samples of a place have in the mean: contribution, and its square.
struct Moments {
  double mean = 0, square = 0;
};

Moments moments(const LightTrial& trial, const ByNode& p) {
  const double lit =
      static_cast<double>(std::ranges::count_if(trial.potential, [](float c) { return c > 0; }));
  const double tests = std::popcount(trial.tested);
  Moments sum;
  for_each_bit(trial.seen, [&](std::size_t i) {
    sum.mean += trial.potential[i] * lit / tests;
    if (p[i] > 0) sum.square += double{trial.potential[i]} * trial.potential[i] / p[i] * lit / tests;
  });
  return sum;
}

}  // namespace

/// Grows the tree and its tables.
class LightRegionTable::Grower {
 public:
  Grower(LightRegionTable& table, const std::vector<double>& power_shares)
      : table_(table), power_shares_(power_shares) {}

  void grow(std::size_t node, Trials trials, const ByNode& around, int depth) {
    Counts all;
    for (const LightTrial* t : trials) all.change(*t, 1);
    const ByNode share = shares(all, around);
    const Split split =
        depth < deepest && trials.size() >= 2 * smallest_region ? best_split(trials, all) : Split{};
    if (!is_worth_it(split, all)) return add_region(node, trials, share);
    const auto children = static_cast<std::uint32_t>(table_.tree_.size());
    table_.tree_[node] = {split.plane, static_cast<std::uint32_t>(split.axis) + 4 * children};
    table_.tree_.resize(children + 2);
    const auto middle = std::stable_partition(trials.begin(), trials.end(), [&](const LightTrial* t) {
      return t->place[split.axis] < split.plane;
    });
    grow(children, Trials(trials.begin(), middle), share, depth + 1);
    grow(children + 1, Trials(middle, trials.end()), share, depth + 1);
  }

 private:
  void add_region(std::size_t node, Trials trials, const ByNode& share) {
    table_.tree_[node] = {0, region_leaf + 4 * static_cast<std::uint32_t>(table_.regions())};
    const std::size_t row = table_.seen_.size();
    // a light is chosen best in proportion to the root of its mean square
    for (std::size_t i = 0; i < nodes; ++i) table_.seen_.push_back(static_cast<float>(std::sqrt(share[i])));
    ByNode sum{};
    double lit = 0;
    for (const LightTrial* t : trials) {
      const ByNode p = probabilities(*t, &table_.seen_[row]);
      for (std::size_t i = 0; i < nodes; ++i) sum[i] += p[i], lit += p[i];
    }
    for (std::size_t i = 0; i < nodes; ++i) {
      const bool known = lit > 0 && i < power_shares_.size();
      table_.density_.push_back(known ? static_cast<float>(sum[i] / lit / power_shares_[i]) : 1.f);
    }
  }

  LightRegionTable& table_;
  const std::vector<double>& power_shares_;
};

LightRegionTable::LightRegionTable(const std::vector<LightTrial>& trials,
                                   const std::vector<double>& power_shares) {
  std::vector<const LightTrial*> learned, kept;
  for (std::size_t i = 0; i < trials.size(); ++i) (i % 4 == 3 ? kept : learned).push_back(&trials[i]);
  tree_.resize(1);
  ByNode all_seen;
  all_seen.fill(1);
  Grower(*this, power_shares).grow(0, learned, all_seen, 0);
  for (std::size_t i = 0; i < nodes; ++i)
    inverse_power_.push_back(i < power_shares.size() ? static_cast<float>(1 / power_shares[i]) : 0.f);
  gain_ = judge(kept);
}

std::size_t LightRegionTable::region_at(const Vec3f& place) const {
  const RegionNode* node = &tree_[0];
  while (node->link % 4 != region_leaf)
    node = &tree_[node->link / 4 + (node->plane <= place[static_cast<int>(node->link % 4)] ? 1 : 0)];
  return node->link / 4;
}

double LightRegionTable::judge(const std::vector<const LightTrial*>& trials) const {
  constexpr double dark = 0.1;  // of the mean; darker places count less
  ByNode unknown;
  unknown.fill(1);
  const std::vector<float> all_seen(nodes, 1.f);
  double mean = 0;
  for (const LightTrial* t : trials) mean += moments(*t, unknown).mean / static_cast<double>(trials.size());
  double without = 0, with = 0;
  for (const LightTrial* t : trials) {
    const Moments bounds = moments(*t, probabilities(*t, all_seen.data()));
    const Moments learned = moments(*t, probabilities(*t, &seen_[region_at(t->place) * nodes]));
    const double scale = bounds.mean * bounds.mean + dark * dark * mean * mean;
    if (!(scale > 0)) continue;
    without += bounds.square / scale;
    with += learned.square / scale;
  }
  return with > 0 ? without / with : 1;
}

LightRegions LightRegionTable::view() const {
  return {tree_.data(), seen_.data(), density_.data(), inverse_power_.data(), nullptr};
}

}  // namespace castray
