// Refines an OFF mesh with CGAL: subdivide SCHEME LEVELS < in.off > out.off
// Schemes: doo-sabin, sqrt-3, loop, catmull-clark.

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/subdivision_method_3.h>

#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

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
        mesh.add_vertex(Kernel::Point_3(x, y, z));
    }
    for (std::size_t f = 0; f < faces; ++f) {
        std::size_t size;
        in >> size;
        std::vector<Mesh::Vertex_index> corners;
        for (std::size_t c = 0; in && c < size; ++c) {
            Mesh::size_type v;
            in >> v;
            corners.emplace_back(v);
        }
        if (!in || mesh.add_face(corners) == Mesh::null_face()) {
            return false;
        }
    }
    return true;
}

// Writes vertices and faces, numbered as they are stored.
static void write(std::ostream& out, const Mesh& mesh) {
    out << "OFF\n" << mesh.number_of_vertices() << ' ' << mesh.number_of_faces() << " 0\n" << std::setprecision(17);
    for (const auto v : mesh.vertices()) {
        out << mesh.point(v) << '\n';
    }
    for (const auto f : mesh.faces()) {
        out << mesh.degree(f);
        for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) {
            out << ' ' << static_cast<Mesh::size_type>(v);
        }
        out << '\n';
    }
}

int main(int argc, char** argv) {
    if (argc != 3) {
        std::cerr << "usage: subdivide SCHEME LEVELS < in.off > out.off\n";
        return 2;
    }
    const std::string scheme = argv[1];
    const unsigned levels = static_cast<unsigned>(std::strtoul(argv[2], nullptr, 10));
    Mesh mesh;
    if (!read(std::cin, mesh)) {
        std::cerr << "no OFF mesh on standard input\n";
        return 1;
    }
    const auto parameters = CGAL::parameters::number_of_iterations(levels);
    if (scheme == "doo-sabin") {
        CGAL::Subdivision_method_3::DooSabin_subdivision(mesh, parameters);
    } else if (scheme == "sqrt-3") {
        CGAL::Subdivision_method_3::Sqrt3_subdivision(mesh, parameters);
    } else if (scheme == "loop") {
        CGAL::Subdivision_method_3::Loop_subdivision(mesh, parameters);
    } else if (scheme == "catmull-clark") {
        CGAL::Subdivision_method_3::CatmullClark_subdivision(mesh, parameters);
    } else {
        std::cerr << "unknown scheme " << scheme << "\n";
        return 2;
    }
    mesh.collect_garbage();
    write(std::cout, mesh);
    return 0;
}
