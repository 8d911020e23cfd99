#include "ros/shared_models.h"

#include <gtest/gtest.h>

#include <thread>

#include "model/random_model.h"

namespace recognition {
namespace {

std::shared_ptr<const ModelDatabase> databaseOfOne(const std::string& name) {
  const auto database = std::make_shared<ModelDatabase>();
  database->objects.push_back(std::make_shared<const ObjectModel>(randomModel(name)));
  return database;
}

TEST(SharedPreparedModels, AreMadeOnceADatabaseWhoeverAsks) {
  const auto database = databaseOfOne("one"), other = databaseOfOne("other");
  std::shared_ptr<const PreparedModels> here, there;
  std::thread thread([&] { there = sharedPreparedModels(database); });
  here = sharedPreparedModels(database);
  thread.join();
  EXPECT_EQ(here, there);
  EXPECT_EQ(here->count(), 1);
  EXPECT_NE(sharedPreparedModels(other), here);
}

TEST(SharedPreparedModels, AreGoneWithTheirLastUser) {
  const auto database = databaseOfOne("one");
  const std::weak_ptr<const PreparedModels> gone = sharedPreparedModels(database);
  EXPECT_TRUE(gone.expired());
  EXPECT_TRUE(sharedPreparedModels(database));
}

}  // namespace
}  // namespace recognition
