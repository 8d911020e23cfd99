#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/model/object_model.h"
#include "ros/messages.h"

namespace recognition {

/// The objects that one of several hypothesis_generation nodelets searches for.
struct ShardObjects {
  int shard = 0;
  int shards = 1;
  std::vector<std::string> names;  ///< these; if empty, each `shards`-th object by name from number `shard` on

  /// Those of the database. Throws std::invalid_argument for a name that it does not have.
  ModelDatabase select(const ModelDatabase& all) const;
};

/// What the shards have found in one round over one frame.
class ShardResults {
 public:
  explicit ShardResults(int shards = 1) : shards_(shards) {}

  /// Waits for the results of this round; forgets those of earlier rounds and of other frames.
  void expect(const ros::Time& stamp, int round);

  /// Takes a shard's results, or leaves them if they are of an earlier round or another frame, or are there already.
  void add(const messages::HypothesisArrayConstPtr& results);

  /// Shards whose results for the round are not there, by number.
  std::vector<int> missing() const;

  /// All results of the round in the order in which one generator over all objects has them: by object.
  messages::HypothesisArrayPtr merged() const;

 private:
  bool expected(const messages::HypothesisArray& results) const;

  int shards_;
  ros::Time stamp_;
  int round_ = 0;
  std::vector<messages::HypothesisArrayConstPtr> results_;  // of the round, and of later ones that came early
};

}  // namespace recognition
