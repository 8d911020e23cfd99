#include "fuzz/fuzz.h"
#include "rgbd_recognition/meshes/mesh.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  recognition::writeSeed("triangle.ply",
                              "ply\nformat ascii 1.0\ncomment TextureFile t.png\nelement vertex 3\nproperty float x\n"
                              "property float y\nproperty float z\nproperty float texture_u\nproperty float texture_v\n"
                              "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0\n"
                              "10 0 0 1 0\n0 10 0 0 1\n3 0 1 2\n");
  recognition::writeSeed("triangle.obj",
                              "mtllib t.mtl\nv 0 0 0\nv 10 0 0\nv 0 10 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nusemtl m\n"
                              "f 1/1/1 2/2/1 3/3/1\n");
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace recognition;
  const bool obj = size > 0 && data[0] != 'p';  // a PLY file begins with "ply"
  const std::string file = inputFile(obj ? "mesh.obj" : "mesh.ply", data, size);
  mayRefuse([&] { readMesh(file, 0.001); });
  return 0;
}
