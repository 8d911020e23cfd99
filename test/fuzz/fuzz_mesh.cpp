// Meshes of every format, and their MTL files and TGA textures; the first byte chooses which.
#include <iterator>

#include "fuzz/fuzz.h"
#include "meshes/files_beside.h"
#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {
namespace {

const char* const kKinds[] = {"mesh.ply", "mesh.obj", "mesh.glb", "mesh.dae",
                              "mesh.stl", "t.mtl",    "t.tga",    "mesh.gltf"};

const std::string kObj =
    "mtllib t.mtl\nv 0 0 0\nv 10 0 0\nv 0 10 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\n"
    "usemtl n\nf 1 2 3\n";

}  // namespace
}  // namespace recognition

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using namespace recognition;
  const std::string ply =
      "ply\nformat ascii 1.0\ncomment TextureFile t.tga\ncomment TextureFile u.tga\nelement vertex 3\nproperty float "
      "x\n"
      "property float y\nproperty float z\nproperty float texture_u\nproperty float texture_v\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\n";
  writeSeed("vertex.ply", '\0' + ply + "end_header\n0 0 0 0 0 1 2 3\n10 0 0 1 0 4 5 6\n0 10 0 0 1 7 8 9\n3 0 1 2\n");
  writeSeed("corner.ply", '\0' + ply +
                              "property list uchar float texcoord\nproperty int texnumber\nend_header\n"
                              "0 0 0 0 0 1 2 3\n10 0 0 1 0 4 5 6\n0 10 0 0 1 7 8 9\n3 0 1 2 6 0 0 1 0 0 1 0\n");
  writeSeed("triangle.obj", '\1' + kObj);
  writeSeed("colors.obj", "\1\xef\xbb\xbfv 0 0 0 1 0 0\rv 10 0 0 0 1 0\rv 0 10 0 0 0 1\rf -3 -2 -1\r");
  writeSeed("box.gltf", std::string("\7") +
                            R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
                            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":0}}]}],"buffers":)"
                            R"([{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAA)"
                            R"(AAAAAAAAAAAAAAAAgD8AAAAA"}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":)"
                            R"([{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})");
  writeSeed("binary.stl", '\4' + std::string(80, ' ') + std::string("\1\0\0\0", 4) + std::string(50, 'A'));
  writeSeed("t.mtl", "\5newmtl m\nmap_Kd -s 1 1 1 t.tga\nnewmtl n\nKd 1 0 0\n");
  std::string tga(18, '\0');
  tga[2] = 10, tga[12] = 4, tga[14] = 4, tga[16] = 24;
  writeSeed("t.tga", '\6' + tga + std::string("\x8f\1\2\3", 4));
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace recognition;
  if (size == 0) return 0;
  const std::string name = kKinds[data[0] % std::size(kKinds)];
  const std::string file = inputFile(name, data + 1, size - 1);
  if (name == "t.tga") decodeTga(std::string(data + 1, data + size));
  if (name == "t.mtl") writeText(fuzzFolder() / "mesh.obj", kObj);
  const std::string mesh = name == "t.mtl" || name == "t.tga" ? fuzzFolder() / "mesh.obj" : file;
  mayRefuse([&] { readMesh(mesh, 0.001); });
  return 0;
}
