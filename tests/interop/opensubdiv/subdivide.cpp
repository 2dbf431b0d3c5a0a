// Refines a mesh with OpenSubdiv and prints the vertices of the last level.
// Input: scheme (catmark|loop) boundary (none|edge|edgecorner) creasing (uniform|chaikin) triangles (catmark|smooth) levels
//        vertices faces creases corners, then x y z each, then n v... each, then a b s each, then v s each.
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

using namespace OpenSubdiv;

struct Point {
    double x[3];
    void Clear(void * = nullptr) { x[0] = x[1] = x[2] = 0; }
    void AddWithWeight(Point const &p, double w) { for (int k = 0; k < 3; ++k) x[k] += w * p.x[k]; }
};

int main() {
    std::string scheme, boundary, creasing, triangles;
    int levels, n, m, nc, nv;
    std::cin >> scheme >> boundary >> creasing >> triangles >> levels >> n >> m >> nc >> nv;
    std::vector<Point> points(n);
    for (auto &p : points) std::cin >> p.x[0] >> p.x[1] >> p.x[2];
    std::vector<int> sizes(m), vertices, pairs(2 * nc), tagged(nv);
    for (auto &size : sizes) {
        std::cin >> size;
        for (int j = 0, v; j < size; ++j) { std::cin >> v; vertices.push_back(v); }
    }
    std::vector<float> edge(nc), vertex(nv);
    for (int i = 0; i < nc; ++i) std::cin >> pairs[2 * i] >> pairs[2 * i + 1] >> edge[i];
    for (int i = 0; i < nv; ++i) std::cin >> tagged[i] >> vertex[i];

    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(boundary == "none" ? Sdc::Options::VTX_BOUNDARY_NONE
        : boundary == "edge" ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    options.SetCreasingMethod(creasing == "chaikin" ? Sdc::Options::CREASE_CHAIKIN : Sdc::Options::CREASE_UNIFORM);
    options.SetTriangleSubdivision(triangles == "smooth" ? Sdc::Options::TRI_SUB_SMOOTH : Sdc::Options::TRI_SUB_CATMARK);
    Far::TopologyDescriptor mesh;
    mesh.numVertices = n;
    mesh.numFaces = m;
    mesh.numVertsPerFace = sizes.data();
    mesh.vertIndicesPerFace = vertices.data();
    mesh.numCreases = nc;
    mesh.creaseVertexIndexPairs = pairs.data();
    mesh.creaseWeights = edge.data();
    mesh.numCorners = nv;
    mesh.cornerVertexIndices = tagged.data();
    mesh.cornerWeights = vertex.data();
    typedef Far::TopologyRefinerFactory<Far::TopologyDescriptor> Factory;
    auto type = scheme == "loop" ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
    Far::TopologyRefiner *refiner = Factory::Create(mesh, Factory::Options(type, options));
    if (!refiner) return 1;
    refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(levels));
    Far::PrimvarRefinerReal<double> primvar(*refiner);
    for (int level = 1; level <= levels; ++level) {
        std::vector<Point> next(refiner->GetLevel(level).GetNumVertices());
        primvar.Interpolate(level, points, next);
        points = next;
    }
    for (auto const &p : points) std::printf("%.17g %.17g %.17g\n", p.x[0], p.x[1], p.x[2]);
    delete refiner;
}
