#include <csignal>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "model/random_model.h"
#include "model/temporary_directory.h"
#include "rgbd_recognition/model/model_store.h"

namespace recognition {
namespace {

// Lets files grow to a few kilobytes only, as a full disk would.
class FullDisk {
 public:
  FullDisk() {
    previous_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &previous_);
    const rlimit small{4096, previous_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &previous_);
    std::signal(SIGXFSZ, previous_handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit previous_{};
  void (*previous_handler_)(int) = nullptr;
};

// Kills a program that saves without pause, at many moments; what was there before must always load.
TEST(StoreCrash, KilledWriterNeverLeavesHalfAModel) {
  const TemporaryDirectory directory;
  const ModelStore store(directory / "store");
  store.save(randomModel("kept"));
  store.save(randomModel("replaced"));
  for (int attempt = 0; attempt < 25; ++attempt) {
    const pid_t writer = fork();
    ASSERT_GE(writer, 0);
    if (writer == 0) {
      const ObjectModel model = randomModel("replaced");
      for (;;) ModelStore(directory / "store").save(model);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(3 + 2 * attempt));
    kill(writer, SIGKILL);
    int status = 0;
    waitpid(writer, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    const ModelStore::LoadResult result = store.loadAll();
    EXPECT_EQ(result.database->objects.size(), 2u);
    EXPECT_TRUE(result.errors.empty()) << result.errors.front();
  }
  EXPECT_NO_THROW(store.save(randomModel("next")));
}

TEST(StoreCrash, ReadersSeeWholeModelsWhileAWriterReplacesThem) {
  const TemporaryDirectory directory;
  const ModelStore store(directory / "store");
  store.save(randomModel("replaced"));
  const pid_t writer = fork();
  ASSERT_GE(writer, 0);
  if (writer == 0) {
    const ObjectModel model = randomModel("replaced");
    for (;;) ModelStore(directory / "store").save(model);
  }
  for (int i = 0; i < 100; ++i) EXPECT_NO_THROW(store.load("replaced"));
  kill(writer, SIGKILL);
  waitpid(writer, nullptr, 0);
}

TEST(StoreCrash, FullDiskLeavesTheStoreAsItWas) {
  const TemporaryDirectory directory;
  const ModelStore store(directory / "store");
  ObjectModel model = randomModel("box");
  model.challenge_id = 1;
  store.save(model);
  {
    const FullDisk full;
    model.challenge_id = 2;
    EXPECT_THROW(store.save(model), std::runtime_error);
    EXPECT_THROW(store.save(randomModel("other")), std::runtime_error);
  }
  EXPECT_EQ(store.load("box").challenge_id, 1);
  EXPECT_EQ(store.names().size(), 1u);
  for (const auto& entry : std::filesystem::directory_iterator(directory / "store"))
    EXPECT_NE(entry.path().filename().string().rfind(".tmp", 0), 0u) << entry.path();
}

}  // namespace
}  // namespace recognition
