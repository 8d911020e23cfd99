#include <cstdio>
#include <iostream>
#include <mutex>

#include <CLI/CLI.hpp>

#include "rgbd_recognition/simulation/challenge_set.h"

namespace {

using namespace rgbd_recognition;

void showProgress(int done, int total) {
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  std::fprintf(stderr, "\r%d of %d frames%s", done, total, done == total ? "\n" : "");
}

struct Options {
  std::string set = "wg";
  std::string models;
  std::string out;
  std::string color;
  std::string sensor;
  std::uint64_t seed = 1;
  int frames = 0;

  KinectParameters kinect() const {
    KinectParameters parameters = sensor.empty() ? KinectParameters() : KinectParameters::fromYaml(sensor);
    if (!color.empty()) setFromText(parameters.list().front(), color, "kinect");
    return parameters;
  }
};

void addChallenge(CLI::App& app, Options& options) {
  CLI::App* command = app.add_subcommand("challenge", "A test set like the challenge's, as a BOP data set with ground truth");
  command->add_option("--set", options.set, "wg: 176 frames, 434 instances; nist: 399 frames, 831 instances")->check(CLI::IsMember({"wg", "nist"}));
  command->add_option("--models", options.models, "BOP models folder")->required()->check(CLI::ExistingDirectory);
  command->add_option("--seed", options.seed, "everything follows from it");
  command->add_option("--frames", options.frames, "another number of frames, instances in proportion")->check(CLI::PositiveNumber);
  command->add_option("--color", options.color, "vga or sxga (default: sxga, or what --sensor says)")->check(CLI::IsMember({"vga", "sxga"}));
  command->add_option("--sensor", options.sensor, "sensor file, config/sensors/*.yaml")->check(CLI::ExistingFile);
  command->add_option("--out", options.out, "BOP data set to write; an interrupted run goes on")->required();
  command->callback([&options] {
    ChallengeSetParameters set = options.set == "nist" ? ChallengeSetParameters::nist() : ChallengeSetParameters::wg();
    if (options.frames > 0) set = set.withFrames(options.frames);
    writeChallengeSet(set, options.models, options.kinect(), TabletopParameters(), options.seed, options.out, showProgress);
  });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulated RGB-D recordings: rendered scenes seen by a Kinect that is not there");
  app.require_subcommand(1);
  Options options;
  addChallenge(app, options);
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
