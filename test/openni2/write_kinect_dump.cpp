#include <cstdio>
#include <exception>

#include "openni2/kinect_dump.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: write_kinect_dump <BOP scene or split> <folder to write>\n");
    return 2;
  }
  try {
    rgbd_recognition::openni2::writeKinectDump(argv[1], argv[2]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
