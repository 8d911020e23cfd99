#include "simulation/challenge_set.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "simulation/annotate.h"
#include "simulation/random_stream.h"

namespace recognition {
namespace {

constexpr int kFramesPerScene = 50;
const char* const kSplit = "test_kinect";
constexpr int kRedraws = 2;             // with other objects before one is left out
constexpr double kMinAnnotated = 0.05;  // visible share below which a buried object is not part of the truth

template <typename T>
void shuffle(std::vector<T>& items, cv::RNG& rng) {
  for (size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[static_cast<size_t>(rng.uniform(0, static_cast<int>(i)))]);
}

// Instances in each frame: none in the empty ones, the total exactly.
std::vector<int> drawCounts(const ChallengeSetParameters& set, cv::RNG& rng) {
  const int empty = static_cast<int>(std::lround(set.empty_share * set.frames));
  std::vector<int> counts(static_cast<size_t>(set.frames), 0);
  std::fill(counts.begin() + empty, counts.end(), 1);
  for (int left = set.instances - (set.frames - empty); left > 0;) {
    int& count = counts[static_cast<size_t>(rng.uniform(empty, set.frames))];
    if (count >= set.max_instances) continue;
    ++count;
    --left;
  }
  shuffle(counts, rng);
  return counts;
}

Eigen::Vector3d sortedExtents(const CatalogObject& object) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : object.shape.points) box.extend(p);
  Eigen::Vector3d sizes = box.sizes();
  std::sort(sizes.data(), sizes.data() + 3);
  return sizes;
}

// For each object one of nearly the same size, or -1.
std::vector<int> findTwins(const std::vector<CatalogObject>& catalog) {
  std::vector<int> twins(catalog.size(), -1);
  for (size_t i = 0; i < catalog.size(); ++i)
    for (size_t j = 0; j < catalog.size(); ++j) {
      const Eigen::Array3d ratio = sortedExtents(catalog[i]).array() / sortedExtents(catalog[j]).array();
      if (i != j && (ratio - 1.0).abs().maxCoeff() < 0.05) twins[i] = static_cast<int>(j);
    }
  return twins;
}

// Objects in random order, each once before any comes again.
class Deck {
 public:
  Deck(size_t objects, cv::RNG& rng) : cards_(objects), rng_(rng) { std::iota(cards_.begin(), cards_.end(), 0); }

  // The next one that is not in `taken`.
  int draw(const std::vector<int>& taken) {
    for (size_t tries = 0; tries < 2 * cards_.size(); ++tries) {
      if (next_ % cards_.size() == 0) shuffle(cards_, rng_);
      const int card = cards_[next_++ % cards_.size()];
      if (std::find(taken.begin(), taken.end(), card) == taken.end()) return card;
    }
    return cards_[next_++ % cards_.size()];
  }

 private:
  std::vector<int> cards_;
  size_t next_ = 0;
  cv::RNG& rng_;
};

std::string describe(const TabletopPlan& plan, const std::vector<CatalogObject>& catalog, const SetMaking& making) {
  std::string text = "seed: " + std::to_string(making.seed) + "\nframes:\n";
  for (const auto& frame : plan) {
    text += "  - [";
    for (const int index : frame) text += " " + catalog[static_cast<size_t>(index)].name;
    text += " ]\n";
  }
  return text + making.kinect.text() + making.world.text();
}

}  // namespace

ChallengeSetParameters ChallengeSetParameters::withFrames(int count) const {
  ChallengeSetParameters scaled = *this;
  scaled.frames = count;
  scaled.instances = static_cast<int>(std::lround(static_cast<double>(instances) * count / frames));
  return scaled;
}

void ChallengeSetParameters::validate() const {
  const auto require = [](bool good, const std::string& message) {
    if (!good) throw std::invalid_argument("challenge set: " + message);
  };
  require(frames > 0, "frames is " + std::to_string(frames));
  require(empty_share >= 0.0 && empty_share < 1.0, "empty_share is " + std::to_string(empty_share));
  const int filled = frames - static_cast<int>(std::lround(empty_share * frames));
  require(instances >= filled && instances <= filled * max_instances,
          std::to_string(instances) + " instances do not fit into " + std::to_string(filled) + " frames of 1 to " +
              std::to_string(max_instances));
}

TabletopPlan planChallengeSet(const ChallengeSetParameters& set, const std::vector<CatalogObject>& catalog,
                              std::uint64_t seed) {
  set.validate();
  if (catalog.empty()) throw std::invalid_argument("challenge set: no objects");
  cv::RNG rng = randomStream(seed, 1);
  const std::vector<int> twins = findTwins(catalog);
  Deck deck(catalog.size(), rng);
  TabletopPlan plan;
  for (const int count : drawCounts(set, rng)) {
    std::vector<int> frame;
    while (static_cast<int>(frame.size()) < count) {
      frame.push_back(deck.draw(frame));
      const auto room = static_cast<size_t>(count) - frame.size();
      const int twin = twins[static_cast<size_t>(frame.back())];
      if (room > 0 && twin >= 0 && rng.uniform(0.0, 1.0) < 0.3) frame.push_back(twin);
    }
    if (count > 1 && rng.uniform(0.0, 1.0) < set.duplicate_share) frame.back() = frame.front();
    plan.push_back(frame);
  }
  return plan;
}

namespace {

// The scene of one frame, with whatever objects it takes.
class FrameMaker {
 public:
  FrameMaker(int frame, const std::vector<CatalogObject>& catalog, const SetMaking& making)
      : frame_(frame),
        catalog_(catalog),
        making_(making),
        rng_(randomStream(making.seed, 2, static_cast<std::uint64_t>(frame))) {}

  AnnotatedFrame make(std::vector<int> objects) {
    const bool filled = !objects.empty();
    const int max_clutter = making_.world.max_clutter;
    const int clutter = rng_.uniform(filled ? 0 : std::min(2, max_clutter), max_clutter + 1);
    const std::uint64_t seed = (static_cast<std::uint64_t>(rng_.next()) << 32) | rng_.next();
    world_ = drawFrameWorld(making_.world, making_.kinect, seed);
    if (filled && world_.many > 0) objects.insert(objects.end(), static_cast<size_t>(world_.many - 1), objects[0]);
    for (int redraw = 0;; ++redraw) {
      try {
        return attempt(objects, clutter, seed + static_cast<std::uint64_t>(redraw));
      } catch (const UnarrangeableScene& error) {
        changeObjects(objects, redraw, error.what());
      }
    }
  }

 private:
  AnnotatedFrame attempt(const std::vector<int>& indices, int clutter, std::uint64_t seed) const {
    const SimulatedKinect kinect(world_.kinect);
    cv::RNG rng = randomStream(seed, 5);
    std::vector<CatalogObject> aged;
    for (const int index : indices) aged.push_back(age(catalog_[static_cast<size_t>(index)], world_.aging, rng));
    std::vector<const CatalogObject*> objects;
    for (const CatalogObject& object : aged) objects.push_back(&object);
    const TabletopScene scene = composeTabletop(objects, clutter, kinect.depthCamera(), world_.tabletop, seed);
    AnnotatedFrame frame = captureAnnotated(scene.scene, scene.objects, kinect, seed, seed);
    auto& truth = frame.objects;
    truth.erase(std::remove_if(truth.begin(), truth.end(),
                               [](const AnnotatedObject& o) { return o.visibility.fraction() < kMinAnnotated; }),
                truth.end());
    return frame;
  }

  // Others (or other places) twice, then one fewer each time: an empty table can always be arranged.
  void changeObjects(std::vector<int>& objects, int redraw, const std::string& why) {
    if (objects.empty()) throw std::runtime_error("frame " + std::to_string(frame_) + ": " + why);
    if (redraw >= kRedraws) objects.pop_back();
    if (!making_.keep_objects)
      for (int& index : objects) index = rng_.uniform(0, static_cast<int>(catalog_.size()));
    making_.log("frame " + std::to_string(frame_) + ": " + why + "; drawn anew with " + std::to_string(objects.size()) +
                " objects");
  }

  const int frame_;
  const std::vector<CatalogObject>& catalog_;
  const SetMaking& making_;
  cv::RNG rng_;
  FrameWorld world_;
};

}  // namespace

void writeTabletops(const TabletopPlan& plan, const std::vector<CatalogObject>& catalog, const SetMaking& making,
                    const BopWriter& writer) {
  making.world.parameters.validate();
  writer.claim(describe(plan, catalog, making));
  std::vector<int> mine;
  for (size_t i = 0; i < plan.size(); ++i)
    if (making.shard.takes(i)) mine.push_back(static_cast<int>(i));
  const auto count = static_cast<int>(mine.size());
  std::atomic<int> done{0};
  cv::parallel_for_(
      cv::Range(0, count),
      [&](const cv::Range& range) {
        for (int k = range.start; k < range.end; ++k) {
          const int frame = mine[static_cast<size_t>(k)];
          if (!writer.has(frame))
            writer.write(frame, FrameMaker(frame, catalog, making).make(plan[static_cast<size_t>(frame)]));
          making.progress(++done, count);
        }
      },
      count);
  writer.finish(static_cast<int>(plan.size()), !making.shard.whole());
}

void writeChallengeSet(const ChallengeSetParameters& set, const std::string& models_directory, const SetMaking& making,
                       const std::string& directory) {
  const std::vector<CatalogObject> catalog = loadCatalog(models_directory);
  const BopWriter writer(directory, kSplit, kFramesPerScene);
  writer.copyModels(models_directory);
  writeTabletops(planChallengeSet(set, catalog, making.seed), catalog, making, writer);
}

}  // namespace recognition
