// OpenSubdiv beside planish: refines a mesh uniformly, interpolates its positions and collects the faces of the last
// level, from the same numbers and to the same results, as often as it is asked.
//
// Standard input: a line `scheme levels vertices faces creases`, the positions, for each face its size and vertices, for
// each crease its two vertices and its sharpness; then one line for each run. Standard output: for each run a line with
// seconds, vertices, faces and the sum of the coordinates.
//
// A run is everything from the coarse arrays to the fine ones: the topology of the mesh, its refinement, and the
// interpolation. Arrays and heap are kept from run to run.

#include <chrono>
#include <cstdio>
#include <cstring>
#include <malloc.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <vector>

using namespace OpenSubdiv;

struct Position {
  float x[3];
  void Clear() { x[0] = x[1] = x[2] = 0.0f; }
  void AddWithWeight(const Position &other, float weight) {
    for (int i = 0; i < 3; ++i) x[i] += weight * other.x[i];
  }
};

struct Mesh {
  bool triangles = false;
  int levels = 0;
  std::vector<Position> positions;
  std::vector<int> sizes, vertices, creases;
  std::vector<float> sharpness;
};

static bool read(Mesh &mesh) {
  char scheme[32];
  int n_vertices, n_faces, n_creases;
  if (std::scanf("%31s %d %d %d %d", scheme, &mesh.levels, &n_vertices, &n_faces, &n_creases) != 5) return false;
  mesh.triangles = std::strcmp(scheme, "loop") == 0;
  mesh.positions.resize(n_vertices);
  for (Position &p : mesh.positions)
    if (std::scanf("%f %f %f", &p.x[0], &p.x[1], &p.x[2]) != 3) return false;
  for (int f = 0; f < n_faces; ++f) {
    int size, vertex;
    if (std::scanf("%d", &size) != 1) return false;
    mesh.sizes.push_back(size);
    for (int i = 0; i < size; ++i) {
      if (std::scanf("%d", &vertex) != 1) return false;
      mesh.vertices.push_back(vertex);
    }
  }
  for (int c = 0; c < n_creases; ++c) {
    int a, b;
    float sharpness;
    if (std::scanf("%d %d %f", &a, &b, &sharpness) != 3) return false;
    mesh.creases.insert(mesh.creases.end(), {a, b});
    mesh.sharpness.push_back(sharpness);
  }
  return true;
}

struct Result {
  std::vector<Position> positions, between;
  std::vector<int> faces;
};

static void refine(const Mesh &mesh, Result &result) {
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = int(mesh.positions.size());
  descriptor.numFaces = int(mesh.sizes.size());
  descriptor.numVertsPerFace = mesh.sizes.data();
  descriptor.vertIndicesPerFace = mesh.vertices.data();
  descriptor.numCreases = int(mesh.sharpness.size());
  descriptor.creaseVertexIndexPairs = mesh.creases.data();
  descriptor.creaseWeights = mesh.sharpness.data();
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  const Sdc::SchemeType type = mesh.triangles ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
  Far::TopologyRefiner *refiner = Factory::Create(descriptor, Factory::Options(type, options));
  Far::TopologyRefiner::UniformOptions uniform(mesh.levels);
  uniform.fullTopologyInLastLevel = false;
  refiner->RefineUniform(uniform);

  const Far::TopologyLevel &last = refiner->GetLevel(mesh.levels);
  result.positions.resize(last.GetNumVertices());
  result.between.resize(refiner->GetNumVerticesTotal());
  Far::PrimvarRefiner interpolation(*refiner);
  const Position *from = mesh.positions.data();
  Position *to = result.between.data();
  for (int level = 1; level <= mesh.levels; ++level) {
    if (level == mesh.levels) to = result.positions.data();
    interpolation.Interpolate(level, from, to);
    from = to;
    to += refiner->GetLevel(level).GetNumVertices();
  }
  const int corners = mesh.triangles ? 3 : 4;
  result.faces.resize(size_t(last.GetNumFaces()) * corners);
  int *out = result.faces.data();
  for (int f = 0; f < last.GetNumFaces(); ++f, out += corners)
    std::memcpy(out, last.GetFaceVertices(f).begin(), corners * sizeof(int));
  delete refiner;
}

int main() {
  // memory once taken is kept, so that runs after the first find it warm
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 2147483647);
  Mesh mesh;
  if (!read(mesh)) {
    std::fprintf(stderr, "the mesh ends early\n");
    return 1;
  }
  Result result;
  int asked;
  while ((asked = std::getchar()) != EOF) {
    if (asked != 'r') continue;
    const auto start = std::chrono::steady_clock::now();
    refine(mesh, result);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    double sum = 0.0;
    for (const Position &p : result.positions) sum += double(p.x[0]) + 2.0 * p.x[1] + 3.0 * p.x[2];
    const size_t faces = result.faces.size() / (mesh.triangles ? 3 : 4);
    std::printf("%.9f %zu %zu %.9g\n", time.count(), result.positions.size(), faces, sum);
    std::fflush(stdout);
  }
}
