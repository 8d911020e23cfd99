#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <actionlib/server/action_server.h>
#include <boost/make_shared.hpp>
#include <ros/callback_queue.h>

#include "ros/queued_call.h"

namespace recognition {

/// One goal of an action, for the work on it. Its methods may be called from any thread.
template <typename Action>
class ActionRun {
 public:
  ACTION_DEFINITION(Action)
  using Handle = actionlib::ServerGoalHandle<Action>;

  explicit ActionRun(const Handle& handle) : handle_(handle) {}

  const Goal& goal() const { return *handle_.getGoal(); }
  void tell(const Feedback& feedback) { handle_.publishFeedback(feedback); }

  bool cancelled() const { return cancelled_; }
  /// Has `stop` called as soon as the client cancels, at once if it did already; with null, no more.
  void whenCancelled(const std::function<void()>& stop) {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = stop;
    if (cancelled_ && stop_) stop_();
  }

  bool isOf(const Handle& handle) const { return handle_ == handle; }

  /// By the client. What is not begun is answered here, as its turn may be far.
  void cancel() {
    const std::lock_guard<std::mutex> lock(mutex_);
    cancelled_ = true;
    if (!begun_) handle_.setCanceled(Result(), "cancelled");
    if (stop_) stop_();
  }

  /// False if the goal was cancelled before its turn.
  bool begin() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (cancelled_) return false;
    begun_ = true;
    handle_.setAccepted();
    return true;
  }

  void end(const Result& result) {
    if (result.success)
      handle_.setSucceeded(result, result.message);
    else if (cancelled_)
      handle_.setCanceled(result, result.message);
    else
      handle_.setAborted(result, result.message);
  }

 private:
  Handle handle_;
  std::mutex mutex_;  // guards all below
  bool begun_ = false;
  std::function<void()> stop_;
  std::atomic<bool> cancelled_{false};  // read without it
};

/// An action whose goals are worked on by the threads of a callback queue, in the order in which they came, so that they
/// and the calls of a service in the same queue take turns. An action's result has the fields `success` and `message`.
/// The queue's threads must have ended before this does.
template <typename Action>
class ActionGoals {
 public:
  using Run = ActionRun<Action>;
  using Result = typename Run::Result;

  /// Goals and cancels arrive by `node`, whose queue must not be the one that is kept busy.
  void serve(const ros::NodeHandle& node, const std::string& name, ros::CallbackQueue* queue,
             const std::function<void(Run&, Result*)>& work) {
    queue_ = queue;
    work_ = work;
    server_ = std::make_unique<actionlib::ActionServer<Action>>(
        node, name, [this](const Handle& handle) { onGoal(handle); },
        [this](const Handle& handle) { onCancel(handle); }, false);
    server_->start();
  }

 private:
  using Handle = typename Run::Handle;

  void onGoal(const Handle& handle) {
    const auto run = std::make_shared<Run>(handle);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      runs_.push_back(run);
    }
    queue_->addCallback(boost::make_shared<QueuedCall>([this, run] { work(run); }));
  }

  void onCancel(const Handle& handle) {
    std::shared_ptr<Run> cancelled;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      for (const auto& run : runs_)
        if (run->isOf(handle)) cancelled = run;
    }
    if (cancelled) cancelled->cancel();
  }

  void work(const std::shared_ptr<Run>& run) {
    if (run->begin()) {
      Result result;
      work_(*run, &result);
      run->end(result);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    runs_.erase(std::remove(runs_.begin(), runs_.end(), run), runs_.end());
  }

  ros::CallbackQueue* queue_ = nullptr;
  std::function<void(Run&, Result*)> work_;
  std::mutex mutex_;  // guards runs_
  std::vector<std::shared_ptr<Run>> runs_;
  std::unique_ptr<actionlib::ActionServer<Action>> server_;
};

}  // namespace recognition
