// Refines an OFF mesh of triangles with OpenMesh: subdivide SCHEME LEVELS < in.off > out.off
// Schemes: butterfly.

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>

#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

struct Traits : OpenMesh::DefaultTraits {
    typedef OpenMesh::Vec3d Point;
    typedef OpenMesh::Vec3d Normal;
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

// Reads vertices and faces in their order.
static bool read(std::istream& in, Mesh& mesh) {
    std::string word;
    std::size_t vertices, faces, edges;
    if (!(in >> word >> vertices >> faces >> edges) || word != "OFF") {
        return false;
    }
    for (std::size_t v = 0; v < vertices; ++v) {
        double x, y, z;
        in >> x >> y >> z;
        mesh.add_vertex(Mesh::Point(x, y, z));
    }
    for (std::size_t f = 0; f < faces; ++f) {
        std::size_t size;
        in >> size;
        std::vector<Mesh::VertexHandle> corners;
        for (std::size_t c = 0; in && c < size; ++c) {
            int v;
            in >> v;
            corners.emplace_back(v);
        }
        if (!in || !mesh.add_face(corners).is_valid()) {
            return false;
        }
    }
    return true;
}

int main(int argc, char** argv) {
    if (argc != 3 || std::string(argv[1]) != "butterfly") {
        std::cerr << "usage: subdivide butterfly LEVELS < in.off > out.off\n";
        return 2;
    }
    Mesh mesh;
    if (!read(std::cin, mesh)) {
        std::cerr << "no OFF mesh on standard input\n";
        return 1;
    }
    OpenMesh::Subdivider::Uniform::ModifiedButterflyT<Mesh, double> butterfly;
    butterfly.attach(mesh);
    butterfly(static_cast<std::size_t>(std::strtoul(argv[2], nullptr, 10)));
    butterfly.detach();
    std::cout << "OFF\n" << mesh.n_vertices() << ' ' << mesh.n_faces() << " 0\n" << std::setprecision(17);
    for (const auto v : mesh.vertices()) {
        std::cout << mesh.point(v) << '\n';
    }
    for (const auto f : mesh.faces()) {
        std::cout << mesh.valence(f);
        for (auto v = mesh.cfv_iter(f); v.is_valid(); ++v) {
            std::cout << ' ' << v->idx();
        }
        std::cout << '\n';
    }
    return 0;
}
