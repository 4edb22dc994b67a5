// Damaged mesh files end in an Error or in triangles that are consistent in themselves. With
// PLENOFLAME_DAMAGED_FILES in the environment as many are tried as it says.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "solids/mesh.h"
#include "support/damaged_files.h"

namespace plenoflame::test::mesh_fuzz_test {
namespace {

constexpr int kFiles = 6000;  ///< of all kinds together, unless said otherwise

template <class T>
void append(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

struct Sample {
  const char* ending;
  std::string bytes;
};

std::vector<Sample> samples() {
  std::vector<Sample> list;
  list.push_back(
      {"obj",
       "# a cube\nmtllib a.mtl\no cube\nv -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\n"
       "v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n"
       "vn 0 0 -1\ng side\nusemtl red\nf 1/1/2 4/2/2 3/3/2 2/1/2\nf 5/1 6/2 \\\n7/3 8/1\n"
       "f -7 -6 -2 -1\nf 2//1 3//1 7//1 6//1\ns off\nf 1 2 6 5 8 4\n"});
  const std::string facet =
      "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1.5e0 0 0\n  vertex 0 1 0\n"
      " endloop\nendfacet\n";
  list.push_back({"stl", "solid name\n" + facet + facet + "endsolid name\n"});
  std::string binary(80, ' ');
  append(binary, std::uint32_t{3});
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 12; ++i) append(binary, static_cast<float>(i * i % 7 + k));
    append(binary, std::uint16_t{0});
  }
  list.push_back({"stl", binary});
  const std::string header =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
      "property float ny\nproperty float nz\nproperty float u\nproperty float v\nelement face 3\n"
      "property list uchar int vertex_indices\nproperty uchar red\nend_header\n";
  list.push_back({"ply", "ply\nformat ascii 1.0\ncomment c\n" + header +
                             "0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n1 1 0 0 0 1 1 1\n0 1 0 0 0 1 0 1\n"
                             "4 0 1 2 3 9\n3 0 2 3 9\n3 1 2 0 9\n"});
  for (const std::string order : {"little", "big"}) {
    std::string ply = "ply\nformat binary_" + order + "_endian 1.0\n" + header;
    const auto put = [&](auto value) {
      std::string raw;
      append(raw, value);
      if ((order == "big") == (std::endian::native == std::endian::little))
        std::reverse(raw.begin(), raw.end());
      ply += raw;
    };
    for (int i = 0; i < 32; ++i) put(static_cast<float>(i % 5));
    for (int k = 0; k < 3; ++k) {
      ply += '\3';
      for (int i = 0; i < 3; ++i) put(std::int32_t{(i + k) % 4});
      ply += '\7';
    }
    list.push_back({"ply", ply});
  }
  return list;
}

TEST(MeshFuzz, DamagedFilesAreReadOrRefused) {
  const TemporaryFolder folder;
  const std::vector<Sample> whole = samples();
  std::mt19937_64 random(20240607);
  const std::vector<std::string> words{
      "-1", "0",  "4294967295", "1e300", "nan",    "inf",  " ",      "\n",
      "/",  "f ", "v ",         "list",  "facet ", "\\\n", "1e-320", "99999999999999999999"};
  int read = 0, refused = 0;
  for (int n = 0, files = damaged_files_wanted(kFiles); n < files; ++n) {
    const Sample& sample = whole[static_cast<std::size_t>(n) % whole.size()];
    const std::string path = folder.file(std::string("a.") + sample.ending);
    write_bytes(path, damage_text(sample.bytes, words, random));
    try {
      const MeshData mesh = read_mesh(path, "surface", {});
      ++read;
      ASSERT_FALSE(mesh.triangles.empty());
      ASSERT_TRUE(mesh.texture.empty() || mesh.texture.size() == mesh.vertices.size());
      for (const Vec3& v : mesh.vertices)
        ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
      for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t corner : triangle) ASSERT_LT(corner, mesh.vertices.size());
    } catch (const InputError& error) {
      const std::string text = error.what();
      ASSERT_NE(text.find(path), std::string::npos);
      ASSERT_EQ(text.find('\n'), std::string::npos) << text;
      ++refused;
    }
  }
  for (const Sample& sample : whole) {
    const std::string path = folder.file(std::string("a.") + sample.ending);
    write_bytes(path, sample.bytes);
    EXPECT_NO_THROW(read_mesh(path, "surface", {})) << sample.ending;
  }
  EXPECT_GT(read, refused / 20);
  EXPECT_GT(refused, read / 20);
  std::printf("%d files: %d read, %d refused\n", read + refused, read, refused);
}

}  // namespace
}  // namespace plenoflame::test::mesh_fuzz_test
