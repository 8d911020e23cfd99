#include "ros/hypothesis_shards.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include <boost/make_shared.hpp>

namespace recognition {

ModelDatabase ShardObjects::select(const ModelDatabase& all) const {
  ModelDatabase selected;
  for (const std::string& name : names)
    if (all.find(name) < 0) throw std::invalid_argument("objects: there is no model of " + name);
  for (size_t i = 0; i < all.objects.size(); ++i) {
    const bool named = std::find(names.begin(), names.end(), all.objects[i]->name) != names.end();
    if (names.empty() ? static_cast<int>(i) % shards == shard : named) selected.objects.push_back(all.objects[i]);
  }
  return selected;
}

void ShardResults::expect(const ros::Time& stamp, int round) {
  stamp_ = stamp;
  round_ = round;
  const auto over = [this](const messages::HypothesisArrayConstPtr& results) {
    return results->header.stamp != stamp_ || static_cast<int>(results->round) < round_;
  };
  results_.erase(std::remove_if(results_.begin(), results_.end(), over), results_.end());
}

void ShardResults::add(const messages::HypothesisArrayConstPtr& results) {
  if (results->header.stamp != stamp_ || static_cast<int>(results->round) < round_) return;
  const auto same = [&](const messages::HypothesisArrayConstPtr& other) {
    return other->shard == results->shard && other->round == results->round;
  };
  if (std::none_of(results_.begin(), results_.end(), same)) results_.push_back(results);
}

bool ShardResults::expected(const messages::HypothesisArray& results) const {
  return static_cast<int>(results.round) == round_;
}

std::vector<int> ShardResults::missing() const {
  std::vector<int> missing;
  for (int shard = 0; shard < shards_; ++shard) {
    const auto of_shard = [&](const messages::HypothesisArrayConstPtr& results) {
      return expected(*results) && static_cast<int>(results->shard) == shard;
    };
    if (std::none_of(results_.begin(), results_.end(), of_shard)) missing.push_back(shard);
  }
  return missing;
}

messages::HypothesisArrayPtr ShardResults::merged() const {
  std::vector<messages::HypothesisArrayConstPtr> parts;
  std::copy_if(results_.begin(), results_.end(), std::back_inserter(parts),
               [this](const auto& results) { return expected(*results); });
  std::sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a->shard < b->shard; });
  const auto all = boost::make_shared<messages::HypothesisArray>();
  for (const auto& part : parts) {
    if (part == parts.front()) {
      all->header = part->header;
      all->round = part->round;
      all->models = part->models;
    }
    all->hypotheses.insert(all->hypotheses.end(), part->hypotheses.begin(), part->hypotheses.end());
    all->matches.insert(all->matches.end(), part->matches.begin(), part->matches.end());
    all->cut_short.insert(all->cut_short.end(), part->cut_short.begin(), part->cut_short.end());
  }
  std::stable_sort(all->hypotheses.begin(), all->hypotheses.end(),
                   [](const messages::Hypothesis& a, const messages::Hypothesis& b) { return a.object < b.object; });
  return all;
}

}  // namespace recognition
