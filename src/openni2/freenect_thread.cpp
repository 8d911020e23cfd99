#include "openni2/freenect_thread.h"

#include <sys/time.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

// libfreenect's stand-in that replays recordings (fakenect) lacks this one.
#pragma weak freenect_list_device_attributes
#pragma weak freenect_free_device_attributes

namespace recognition::openni2 {
namespace {

constexpr std::chrono::seconds kIdlePeriod(1);
constexpr std::chrono::milliseconds kStopPatience(500);
constexpr int kEventTimeout = 20000;    // microseconds: how long queued work may wait while frames come
constexpr size_t kMaxComplaints = 500;  // characters

std::string complaints;  // the library's log carries no cookie; written on the thread only

bool isOwnSerial(const std::string& serial) { return serial.find_first_not_of('0') != std::string::npos; }

}  // namespace

FreenectThread::FreenectThread(std::function<void()> idle) : idle_(std::move(idle)) {
  if (freenect_init(&context_, nullptr) < 0) throw std::runtime_error("libfreenect: no access to USB");
  freenect_select_subdevices(context_, FREENECT_DEVICE_CAMERA);  // the tilt motor stays where it is
  freenect_set_log_level(context_, FREENECT_LOG_ERROR);
  freenect_set_log_callback(context_, &FreenectThread::log);
  thread_ = std::thread(&FreenectThread::run, this);
}

FreenectThread::~FreenectThread() {
  thread_.join();
  freenect_shutdown(context_);
}

bool FreenectThread::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  queued_.notify_all();
  return ended_.get_future().wait_for(kStopPatience) == std::future_status::ready;
}

bool FreenectThread::stopping() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return stopping_;
}

void FreenectThread::call(const std::function<void()>& work) {
  if (std::this_thread::get_id() == thread_.get_id()) return work();
  std::packaged_task<void()> task(work);
  std::future<void> done = task.get_future();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    queue_.push(std::move(task));
  }
  queued_.notify_all();
  done.get();
}

std::string FreenectThread::takeComplaints() {
  std::string taken;
  taken.swap(complaints);
  return taken;
}

bool FreenectThread::takeLoss() {
  const bool lost = lost_;
  lost_ = false;
  return lost;
}

void FreenectThread::run() {
  auto next_idle = std::chrono::steady_clock::now() + kIdlePeriod;
  while (true) {
    if (running_streams_ > 0) {
      timeval timeout = {0, kEventTimeout};
      if (freenect_process_events_timeout(context_, &timeout) < 0) {
        lost_ = true;
        std::this_thread::sleep_for(std::chrono::microseconds(kEventTimeout));
      }
    } else {
      std::unique_lock<std::mutex> lock(mutex_);
      queued_.wait_until(lock, next_idle, [this] { return stopping_ || !queue_.empty(); });
    }
    workOff();
    if (stopping()) break;
    if (std::chrono::steady_clock::now() >= next_idle) {
      idle_();
      next_idle = std::chrono::steady_clock::now() + kIdlePeriod;
    }
  }
  ended_.set_value();
}

void FreenectThread::workOff() {
  while (true) {
    std::packaged_task<void()> task;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (queue_.empty()) return;
      task = std::move(queue_.front());
      queue_.pop();
    }
    task();
  }
}

void FreenectThread::log(freenect_context*, freenect_loglevel, const char* message) {
  if (complaints.size() < kMaxComplaints) complaints += message;
}

std::vector<FreenectAddress> listKinects(freenect_context* context) {
  std::vector<FreenectAddress> kinects;
  if (&freenect_list_device_attributes != nullptr) {
    freenect_device_attributes* list = nullptr;
    if (freenect_list_device_attributes(context, &list) < 0) return kinects;
    for (const auto* device = list; device != nullptr; device = device->next) {
      const std::string serial = device->camera_serial != nullptr ? device->camera_serial : "";
      kinects.push_back({"", isOwnSerial(serial) ? serial : "", static_cast<int>(kinects.size())});
    }
    freenect_free_device_attributes(list);
  } else {
    for (int i = 0; i < freenect_num_devices(context); ++i) kinects.push_back({"", "", i});
  }
  for (FreenectAddress& kinect : kinects) {
    kinect.uri = "freenect:" + (kinect.serial.empty() ? std::to_string(kinect.index) : kinect.serial);
  }
  return kinects;
}

}  // namespace recognition::openni2
