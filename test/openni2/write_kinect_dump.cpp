#include <cstdio>
#include <exception>
#include <string>

#include "openni2/kinect_dump.h"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: write_kinect_dump <BOP scene or split> <folder to write> <seconds>\n");
    return 2;
  }
  try {
    recognition::openni2::writeKinectDump(argv[1], argv[2], std::stod(argv[3]));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
