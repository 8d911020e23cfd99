#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>

#include "tools/progress_bar.h"
#include "simulation/challenge_set.h"
#include "simulation/sequence.h"
#include "simulation/turntable.h"
#ifdef RGBD_RECOGNITION_HAS_BAGS
#include "tools/bag_export.h"
#endif

namespace {

using namespace recognition;

using Progress = std::function<void(int, int)>;

// What all recordings have in common.
struct Options {
  std::string models;
  std::string out;
  std::string color;
  std::string sensor;
  std::string bag;
  std::string bag_layout = "challenge";
  std::uint64_t seed = 1;
  int frames = 0;
  bool resume = false;
  std::string shard = "1/1";
  WorldPreset preset = WorldPreset::kHard;

  KinectParameters kinect() const {
    KinectParameters parameters = sensor.empty() ? KinectParameters() : KinectParameters::fromYaml(sensor);
    if (!color.empty()) setFromText(parameters.list().front(), color, "kinect");
    return parameters;
  }

  SetMaking making(const Progress& progress) const {
    SetMaking making;
    making.world = World::of(preset);
    making.kinect = kinect();
    making.seed = seed;
    making.shard = Shard::parse(shard);
    making.progress = progress;
    making.log = [](const std::string& line) { std::cerr << "simulate: " + line + "\n"; };
    return making;
  }
};

// Only for challenge, scene and turntable.
struct ChallengeOptions : Options {
  std::string set = "wg";
};

struct SceneOptions : Options {
  std::vector<int> objects;
  int clutter = 3;
};

struct SequenceOptions : Options {
  std::vector<int> objects;
  int clutter = 3;
  SequenceParameters sequence;
};

struct TurntableOptions : Options {
  std::string mesh;
  double unit = 1.0;  // metres, as everywhere but in BOP's models folders
  int id = 1;
  std::string board;
  TurntableParameters turntable;
};

void addCommon(CLI::App* command, Options& options) {
  command->add_option("--seed", options.seed, "everything follows from it");
  command->add_option("--color", options.color, "vga or sxga (default: sxga, or what --sensor says)")
      ->check(CLI::IsMember({"vga", "sxga"}));
  command->add_option("--sensor", options.sensor, "sensor file, config/sensors/*.yaml")->check(CLI::ExistingFile);
  command->add_option("--out", options.out, "BOP data set to write")->required();
  command->add_flag("--resume", options.resume, "go on with what an interrupted run left in --out");
#ifdef RGBD_RECOGNITION_HAS_BAGS
  command->add_option("--bag", options.bag, "also write the frames and their true poses (tf) as a rosbag");
  command->add_option("--bag-layout", options.bag_layout, "topics and kind of depth in the bag")
      ->check(CLI::IsMember({"challenge", "openni"}));
#endif
}

void addSetOptions(CLI::App* command, Options& options) {
  const std::map<std::string, WorldPreset> presets = {
      {"challenge", WorldPreset::kChallenge}, {"hard", WorldPreset::kHard}, {"wide", WorldPreset::kWide}};
  command->add_option("--preset", options.preset, "challenge, hard (default) or wide: what the frames are like")
      ->transform(CLI::CheckedTransformer(presets, CLI::ignore_case));
  command->add_option("--shard", options.shard, "K/N: only every N-th frame, the K-th process of N into one --out");
}

// A bar that learns the number of frames with the first of them.
Progress progressBar(std::unique_ptr<ProgressBar>& bar, std::mutex& mutex) {
  return [&bar, &mutex](int done, int total) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!bar) bar = std::make_unique<ProgressBar>("simulate", total);
    }
    bar->advance("frame " + std::to_string(done));
  };
}

template <typename Work>
void record(const Options& options, const std::string& split, const Work& work) {
  if (!options.resume && Shard::parse(options.shard).whole() && BopWriter(options.out, split, 1).started())
    throw std::runtime_error(options.out + ": holds frames of an earlier run; --resume goes on with them");
  std::unique_ptr<ProgressBar> bar;
  std::mutex mutex;  // guards the bar's creation
  work(progressBar(bar, mutex));
  bar.reset();
#ifdef RGBD_RECOGNITION_HAS_BAGS
  if (!options.bag.empty())
    exportBag((std::filesystem::path(options.out) / split).string(), options.bag_layout, options.bag);
#else
  static_cast<void>(options), static_cast<void>(split);  // no bags without ROS
#endif
}

void addChallenge(CLI::App& app, ChallengeOptions& options) {
  CLI::App* command = app.add_subcommand("challenge", "A test set like the challenge's, with ground truth");
  command->add_option("--set", options.set, "wg: 176 frames, 434 instances; nist: 399 frames, 831 instances")
      ->check(CLI::IsMember({"wg", "nist"}));
  command->add_option("--models", options.models, "BOP models folder")->required()->check(CLI::ExistingDirectory);
  command->add_option("--frames", options.frames, "another number of frames, instances in proportion")
      ->check(CLI::PositiveNumber);
  addCommon(command, options);
  addSetOptions(command, options);
  command->callback([&options] {
    ChallengeSetParameters set = options.set == "nist" ? ChallengeSetParameters::nist() : ChallengeSetParameters::wg();
    if (options.frames > 0) set = set.withFrames(options.frames);
    record(options, "test_kinect", [&](const Progress& progress) {
      const SetMaking making = options.making(progress);
      set.empty_share = making.world.empty_share;
      writeChallengeSet(set, options.models, making, options.out);
    });
  });
}

TabletopPlan samePlan(const std::vector<CatalogObject>& catalog, const std::vector<int>& ids, int frames) {
  std::vector<int> indices;
  for (const int id : ids) {
    const auto found =
        std::find_if(catalog.begin(), catalog.end(), [id](const CatalogObject& object) { return object.id == id; });
    if (found == catalog.end())
      throw std::invalid_argument("--objects: the models folder has no object " + std::to_string(id));
    indices.push_back(static_cast<int>(found - catalog.begin()));
  }
  return TabletopPlan(static_cast<size_t>(frames), indices);
}

void addScene(CLI::App& app, SceneOptions& options) {
  CLI::App* command = app.add_subcommand("scene", "Scenes with given objects");
  command->add_option("--models", options.models, "BOP models folder")->required()->check(CLI::ExistingDirectory);
  command->add_option("--objects", options.objects, "obj_id of each object on the table, repeats allowed")
      ->delimiter(',');
  command->add_option("--clutter", options.clutter, "other things, at most")->check(CLI::Range(0, 50));
  command->add_option("--frames", options.frames, "scenes, each another room and arrangement (default 1)")
      ->check(CLI::PositiveNumber);
  addCommon(command, options);
  addSetOptions(command, options);
  command->callback([&options] {
    const std::vector<CatalogObject> catalog = loadCatalog(options.models);
    record(options, "test_kinect", [&](const Progress& progress) {
      const BopWriter writer(options.out, "test_kinect", 50);
      writer.copyModels(options.models);
      SetMaking making = options.making(progress);
      making.keep_objects = true;
      making.world.max_clutter = options.clutter;
      writeTabletops(samePlan(catalog, options.objects, std::max(1, options.frames)), catalog, making, writer);
    });
  });
}

void addSequence(CLI::App& app, SequenceOptions& options) {
  CLI::App* command =
      app.add_subcommand("sequence", "Films of given objects: a moving camera, objects moved, things that pass before");
  command->add_option("--models", options.models, "BOP models folder")->required()->check(CLI::ExistingDirectory);
  command->add_option("--objects", options.objects, "obj_id of each object on the table, repeats allowed")
      ->delimiter(',')
      ->required();
  command->add_option("--clutter", options.clutter, "other things, at most")->check(CLI::Range(0, 50));
  command->add_option("--frames", options.frames, "films, each a scene: another room and motion (default 1)")
      ->check(CLI::PositiveNumber);
  const std::map<std::string, CameraPath> paths = {{"still", CameraPath::kStill},
                                                   {"hand", CameraPath::kHandHeld},
                                                   {"arm", CameraPath::kArm},
                                                   {"pan_tilt", CameraPath::kPanTilt}};
  SequenceParameters& sequence = options.sequence;
  command->add_option("--path", sequence.path, "still, hand (default), arm or pan_tilt: how the camera moves")
      ->transform(CLI::CheckedTransformer(paths, CLI::ignore_case));
  command->add_option("--seconds", sequence.seconds, "length of a film")->capture_default_str();
  command->add_option("--rate", sequence.rate, "frames a second")->capture_default_str();
  command->add_option("--moved", sequence.moved, "objects that are carried")->capture_default_str();
  command->add_option("--passing", sequence.passing, "boxes that pass before")->capture_default_str();
  command->add_option("--max-speed", sequence.max_speed, "m/s of what is carried")->capture_default_str();
  command->add_option("--max-turn", sequence.max_turn, "degrees a second, likewise")->capture_default_str();
  command->add_option("--exposure", sequence.exposure, "seconds: motion blur")->capture_default_str();
  command->add_option("--readout", sequence.readout, "seconds: rolling shutter")->capture_default_str();
  addCommon(command, options);
  command->callback([&options] {
    const std::vector<CatalogObject> catalog = loadCatalog(options.models);
    options.preset = WorldPreset::kChallenge;
    record(options, "test_kinect", [&](const Progress& progress) {
      BopWriter(options.out, "test_kinect", 1).copyModels(options.models);
      SequenceSet set;
      set.ids = options.objects;
      set.clutter = options.clutter;
      set.films = std::max(1, options.frames);
      set.kinect = options.kinect();
      set.world = World::of(options.preset);
      set.seed = options.seed;
      set.progress = progress;
      writeSequences(set, options.sequence, catalog, options.out);
    });
  });
}

void addTurntable(CLI::App& app, TurntableOptions& options) {
  CLI::App* command =
      app.add_subcommand("turntable", "A training recording: one object on a turning board with a fiducial");
  command->add_option("--mesh", options.mesh, "mesh file")->required()->check(CLI::ExistingFile);
  command->add_option("--unit", options.unit, "length of the mesh file's unit in metres (BOP: 0.001)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--id", options.id, "obj_id in the ground truth")->check(CLI::PositiveNumber);
  command->add_option("--board", options.board, "board under the object, config/boards/*.yaml")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--views", options.turntable.views, "views of all tilts together");
  command->add_option("--tilts", options.turntable.tilts, "heights of the camera");
  command->add_flag("--upside-down", options.turntable.upside_down, "the object stands on its head");
  addCommon(command, options);
  command->callback([&options] {
    const CatalogObject object =
        loadObject(options.mesh, options.unit, options.id, std::filesystem::path(options.mesh).stem().string());
    const FiducialBoard board = FiducialBoard::fromYaml(options.board);
    record(options, "train_kinect", [&](const Progress& progress) {
      writeTurntable(object, board, options.kinect(), options.turntable, options.seed, options.out, progress);
    });
  });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulated RGB-D recordings: rendered scenes seen by a Kinect that is not there");
  app.require_subcommand(1);
  ChallengeOptions challenge;
  SceneOptions scene;
  TurntableOptions turntable;
  addChallenge(app, challenge);
  addScene(app, scene);
  SequenceOptions sequence;
  addSequence(app, sequence);
  addTurntable(app, turntable);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::cerr << "simulate: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
