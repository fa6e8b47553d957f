// CGAL: all pairs of overlapping boxes, by streamed segment trees (`box_self_intersection_d`).
// Boxes are closed, and each has the size of its particle. 2D scenes use planar boxes. The library
// reports each pair once.

#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/version.h>

#include "runner.hpp"

namespace {

template <int D> struct Box : CGAL::Box_intersection_d::Box_d<double, D, CGAL::Box_intersection_d::ID_NONE> {
    using Base = CGAL::Box_intersection_d::Box_d<double, D, CGAL::Box_intersection_d::ID_NONE>;
    using ID = std::uint32_t;
    std::uint32_t particle;
    Box(double low[D], double high[D], std::uint32_t i) : Base(low, high), particle(i) {}
    ID id() const { return particle; }
};

template <int D> void detect(const runner::Scene<D>& scene, runner::Pairs& pairs) {
    // Reused from one detection to the next.
    static std::vector<Box<D>> boxes;
    boxes.clear();
    for (std::uint32_t i = 0; i < scene.centres.size(); i++) {
        double low[D], high[D];
        for (int k = 0; k < D; k++) {
            low[k] = scene.centres[i][k] - scene.radius(i);
            high[k] = scene.centres[i][k] + scene.radius(i);
        }
        boxes.emplace_back(low, high, i);
    }
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box<D>& a, const Box<D>& b) {
        if (scene.touch(a.particle, b.particle)) pairs.push_back({a.particle, b.particle});
    });
}

}  // namespace

int main() { runner::serve("cgal-boxes", CGAL_VERSION_STR, detect<2>, detect<3>); }
