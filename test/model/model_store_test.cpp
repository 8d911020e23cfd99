#include "rgbd_recognition/model/model_store.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/durable_file.h"
#include "model/random_model.h"
#include "model/temporary_directory.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class Store : public testing::Test {
 protected:
  std::string file(const std::string& model, const std::string& name) {
    return directory_ / ("store/" + model + "/" + name);
  }

  // Why `bad` does not load; checks that `good` still does.
  std::string reason() {
    const ModelStore::LoadResult result = store_.loadAll();
    EXPECT_EQ(result.database->objects.size(), 1u);
    EXPECT_EQ(result.database->find("good"), 0);
    EXPECT_EQ(result.errors.size(), 1u);
    return result.errors.empty() ? "loaded" : result.errors[0];
  }

  TemporaryDirectory directory_;
  ModelStore store_{directory_ / "store"};
};

TEST_F(Store, RoundTrip) {
  const ObjectModel model = randomModel("box");
  store_.save(model);
  const ObjectModel loaded = store_.load("box");
  EXPECT_EQ(loaded.name, "box");
  EXPECT_EQ(loaded.challenge_id, 12);
  EXPECT_EQ(loaded.source, model.source);
  EXPECT_EQ(loaded.provenance, model.provenance);
  EXPECT_NEAR(loaded.extents.sigma_d, model.extents.sigma_d, 1e-8);
  ASSERT_EQ(loaded.rest_planes.size(), model.rest_planes.size());
  for (size_t i = 0; i < model.rest_planes.size(); ++i) {
    EXPECT_LT((loaded.rest_planes[i].normal - model.rest_planes[i].normal).norm(), 1e-6f);
    EXPECT_EQ(loaded.rest_planes[i].offset, model.rest_planes[i].offset);
  }
  ASSERT_EQ(loaded.cloud.size(), model.cloud.size());
  for (size_t i = 0; i < model.cloud.size(); ++i) {
    EXPECT_EQ(loaded.cloud[i].position, model.cloud[i].position);
    EXPECT_EQ(loaded.cloud[i].normal, model.cloud[i].normal);
    EXPECT_EQ(loaded.cloud[i].rgb, model.cloud[i].rgb);
  }
  ASSERT_EQ(loaded.features.size(), 2u);
  for (const auto& [type, features] : model.features) {
    const ModelFeatures& other = loaded.features.at(type);
    EXPECT_EQ(other.positions, features.positions);
    EXPECT_EQ(other.view_directions, features.view_directions);
    EXPECT_EQ(other.orientations, features.orientations);  // none for kSurf64
    EXPECT_EQ(other.sizes, features.sizes);
    EXPECT_EQ(other.views, features.views);
    ASSERT_EQ(other.descriptors.size(), features.descriptors.size());
    for (int i = 0; i < features.count(); ++i) {
      EXPECT_LT(cv::norm(unitDescriptors(other.descriptors.row(i)), features.descriptors.row(i)), 0.03);
    }
    EXPECT_EQ(cv::norm(other.descriptors, quantizedDescriptors(features.descriptors), cv::NORM_INF), 0.0);
  }
}

TEST_F(Store, LoadsOnlyTheTypesAskedFor) {
  store_.save(randomModel("box"));
  const ObjectModel model = store_.load("box", {DescriptorType::kSurf64});
  EXPECT_EQ(model.features.size(), 1u);
  EXPECT_EQ(model.features.count(DescriptorType::kSurf64), 1u);
}

TEST_F(Store, ReplacesRemovesRenamesAndSorts) {
  for (const char* name : {"zebra", "box", "cup"}) store_.save(randomModel(name));
  ObjectModel other = randomModel("box");
  other.challenge_id = 5;
  store_.save(other);
  EXPECT_EQ(store_.load("box").challenge_id, 5);
  EXPECT_THAT(store_.names(), ElementsAre("box", "cup", "zebra"));
  store_.remove("cup");
  store_.rename("zebra", "ape");
  EXPECT_THAT(store_.names(), ElementsAre("ape", "box"));
  EXPECT_EQ(store_.load("ape").name, "ape");
  EXPECT_THROW(store_.rename("ape", "box"), std::runtime_error);
  EXPECT_THROW(store_.remove("cup"), std::runtime_error);
  EXPECT_THROW(store_.load("cup"), std::runtime_error);
}

TEST_F(Store, AbsentDirectory) {
  EXPECT_TRUE(store_.names().empty());
  EXPECT_THROW(store_.loadAll(), std::runtime_error);
  EXPECT_THROW(ModelStore(""), std::invalid_argument);
}

TEST_F(Store, RefusesNames) {
  for (const std::string& name : std::vector<std::string>{"", ".hidden", "..", "a/b", "a b", "a\nb", "caf\xc3\xa9"})
    EXPECT_THROW(store_.save(randomModel(name)), std::invalid_argument) << name;
  EXPECT_THROW(store_.save(randomModel(std::string(10000, 'a'))), std::invalid_argument);
  EXPECT_THROW(store_.load("../box"), std::invalid_argument);
  EXPECT_NO_THROW(store_.save(randomModel(std::string(100, 'a'))));
}

TEST_F(Store, RefusesModelsThatCouldNotBeReadBack) {
  ObjectModel model = randomModel("box");
  model.cloud[3].position.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(store_.save(model), std::invalid_argument);
  model = randomModel("box");
  model.features[DescriptorType::kSift].sizes.pop_back();
  EXPECT_THROW(store_.save(model), std::invalid_argument);
  model = randomModel("box");
  model.features[DescriptorType::kSift].descriptors.row(2).setTo(0);
  EXPECT_THROW(store_.save(model), std::invalid_argument);
  EXPECT_TRUE(store_.names().empty());
}

TEST_F(Store, TruncatedFilesAreNamedAndTheOthersLoad) {
  store_.save(randomModel("good"));
  for (const char* name : {"model.yaml", "cloud.pcd", "features_sift.pcd", "features_surf64.pcd"}) {
    store_.save(randomModel("bad"));
    const std::uintmax_t size = fs::file_size(file("bad", name));
    for (const std::uintmax_t kept : {size - 1, size / 2, std::uintmax_t(0)}) {
      fs::resize_file(file("bad", name), kept);
      EXPECT_THAT(reason(), testing::AllOf(HasSubstr("bad"), HasSubstr(name))) << kept;
    }
    fs::remove(file("bad", name));
    EXPECT_THAT(reason(), HasSubstr(name));
  }
}

TEST_F(Store, FlippedBytesAreNoticedEverywhere) {
  store_.save(randomModel("good"));
  for (const char* name : {"model.yaml", "cloud.pcd", "features_sift.pcd"}) {
    store_.save(randomModel("bad"));
    const std::string bytes = readText(file("bad", name));
    for (size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 23) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
      writeText(file("bad", name), damaged);
      EXPECT_THAT(reason(), HasSubstr("bad")) << name << " byte " << at;
    }
  }
}

TEST_F(Store, NewerFormatIsSkipped) {
  store_.save(randomModel("good"));
  store_.save(randomModel("bad"));
  std::string text = readText(file("bad", "model.yaml"));
  text.replace(text.find("format_version: 2"), 17, "format_version: 9");
  writeText(file("bad", "model.yaml"), text);
  EXPECT_THAT(reason(), HasSubstr("format 9, newer"));
}

TEST_F(Store, FirstFormatIsRead) {  // where each descriptor had a scale of its own
  const ObjectModel model = randomModel("box");
  store_.save(model);
  std::string text = readText(file("box", "model.yaml"));
  text.replace(text.find("format_version: 2"), 17, "format_version: 1");
  text.resize(text.find("description_crc32"));
  text += "description_crc32: \"" + checksum(text) + "\"\n";
  writeText(file("box", "model.yaml"), text);
  const ObjectModel loaded = store_.load("box");
  for (const auto& [type, features] : model.features)
    EXPECT_LE(cv::norm(loaded.features.at(type).descriptors, quantizedDescriptors(features.descriptors), cv::NORM_INF),
              2.0);
}

TEST_F(Store, CopiedDirectoryUnderAnotherNameIsNoSecondModel) {
  store_.save(randomModel("good"));
  fs::copy(directory_ / "store/good", directory_ / "store/bad", fs::copy_options::recursive);
  EXPECT_THAT(reason(), HasSubstr("good"));
}

TEST_F(Store, CopiedStoreLoads) {
  store_.save(randomModel("good"));
  fs::copy(directory_ / "store", directory_ / "copy", fs::copy_options::recursive);
  EXPECT_EQ(ModelStore(directory_ / "copy").loadAll().database->objects.size(), 1u);
}

// What a writer leaves that was killed: before the exchange, or between the two renames where directories cannot be
// exchanged.
TEST_F(Store, LeftoversOfKilledWritersAreIgnoredThenCleaned) {
  store_.save(randomModel("good"));
  store_.save(randomModel("kept"));
  fs::create_directory(directory_ / "store/.tmp-good");
  writeText(directory_ / "store/.tmp-good/cloud.pcd", "half");
  fs::rename(directory_ / "store/kept", directory_ / "store/.old-kept");
  EXPECT_EQ(store_.loadAll().database->objects.size(), 1u);
  EXPECT_TRUE(store_.loadAll().errors.empty());
  store_.save(randomModel("new"));
  EXPECT_THAT(store_.names(), ElementsAre("good", "kept", "new"));
  EXPECT_FALSE(fs::exists(directory_ / "store/.tmp-good"));
  EXPECT_FALSE(fs::exists(directory_ / "store/.old-kept"));
}

TEST_F(Store, SecondWriterIsRefused) {
  const ModelStore other(store_.directory());
  store_.save(randomModel("good"));
  {
    const auto held = store_.lock();
    EXPECT_THROW(other.save(randomModel("box")), std::runtime_error);
    EXPECT_THROW(other.remove("good"), std::runtime_error);
    EXPECT_NO_THROW(store_.save(randomModel("cup")));
    EXPECT_EQ(other.loadAll().database->objects.size(), 2u);
  }
  EXPECT_NO_THROW(other.save(randomModel("box")));
}

TEST_F(Store, NoPlaceToWrite) {
  writeText(directory_ / "file", "");
  EXPECT_THROW(ModelStore(directory_ / "file/store").save(randomModel("box")), std::runtime_error);
}

TEST_F(Store, OneFileCarriesAModelToAnotherStore) {
  const std::string name(90, 'n');
  store_.save(randomModel(name));
  store_.exportModel(name, directory_ / "model.tar");
  EXPECT_EQ(std::system(("tar -tf " + (directory_ / "model.tar") + " > " + (directory_ / "list")).c_str()), 0);
  EXPECT_THAT(readText(directory_ / "list"), HasSubstr(name + "/features_sift.pcd"));
  const ModelStore other(directory_ / "other");
  EXPECT_EQ(other.importModel(directory_ / "model.tar"), name);
  EXPECT_EQ(other.load(name).features.at(DescriptorType::kSift).positions,
            store_.load(name).features.at(DescriptorType::kSift).positions);
  EXPECT_THROW(other.importModel(directory_ / "model.tar"), std::runtime_error);  // there already
}

TEST_F(Store, StampsTellWhatChanged) {
  EXPECT_TRUE(store_.stamps().empty());
  store_.save(randomModel("box"));
  store_.save(randomModel("can"));
  const ModelStore::Stamps first = store_.stamps();
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(store_.stamps(), first);
  store_.save(randomModel("box"));
  const ModelStore::Stamps second = store_.stamps();
  EXPECT_NE(second.at("box"), first.at("box"));
  EXPECT_EQ(second.at("can"), first.at("can"));
  store_.remove("box");
  EXPECT_EQ(store_.stamps().count("box"), 0u);
}

TEST_F(Store, DamagedFilesAreNotImported) {
  store_.save(randomModel("box"));
  store_.exportModel("box", directory_ / "model.tar");
  const std::string whole = readText(directory_ / "model.tar");
  const ModelStore other(directory_ / "other");
  const auto refuse = [&](const std::string& bytes) {
    writeText(directory_ / "bad.tar", bytes);
    EXPECT_THROW(other.importModel(directory_ / "bad.tar"), std::runtime_error);
  };
  refuse("");
  refuse("no archive");
  refuse(std::string(4096, 'x'));
  refuse(std::string(1024, '\0'));
  for (size_t kept = 100; kept + 1024 < whole.size(); kept += whole.size() / 9) refuse(whole.substr(0, kept));
  for (const size_t at : {size_t(10), size_t(600), whole.size() / 2}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    refuse(damaged);
  }
  EXPECT_THROW(other.importModel(directory_ / "absent.tar"), std::runtime_error);
  EXPECT_TRUE(other.names().empty());
}

}  // namespace
}  // namespace recognition
