// nanoflann: a k-d tree, queried once per particle in the order of the tree, for all particles
// within a distance, unsorted. The library compares squared distances with `<`, so the search
// radius is wider by 2^-40, and `touch` decides.

#include <nanoflann.hpp>

#include "runner.hpp"

namespace {

// Names differ between versions.
#if NANOFLANN_VERSION >= 0x150
using Parameters = nanoflann::SearchParameters;
const Parameters parameters(0.0f, false);
template <class Tree> const auto& in_order(const Tree& tree) { return tree.vAcc_; }
#else
using Parameters = nanoflann::SearchParams;
const Parameters parameters(32, 0.0f, false);
template <class Tree> const auto& in_order(const Tree& tree) { return tree.vAcc; }
#endif

template <int D> struct Cloud {
    const std::vector<std::array<double, D>>& centres;
    std::size_t kdtree_get_point_count() const { return centres.size(); }
    double kdtree_get_pt(std::uint32_t i, std::size_t k) const { return centres[i][k]; }
    template <class Box> bool kdtree_get_bbox(Box&) const { return false; }
};

// Passes the particles found directly to the contact test.
template <int D> struct Visitor {
    const runner::Scene<D>& scene;
    runner::Pairs& pairs;
    const double square;
    std::uint32_t i = 0;
    std::size_t size() const { return 0; }
    bool full() const { return true; }
    bool addPoint(double, std::uint32_t j) {
        if (i < j && scene.touch(i, j)) pairs.push_back({i, j});
        return true;
    }
    double worstDist() const { return square; }
    void sort() {}
};

template <int D> void detect(const runner::Scene<D>& scene, runner::Pairs& pairs) {
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud<D>>, Cloud<D>, D, std::uint32_t>;
    if (scene.centres.empty()) return;
    const Cloud<D> cloud{scene.centres};
    const Tree tree(D, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    const double reach = scene.reach();
    Visitor<D> visitor{scene, pairs, reach * reach * (1.0 + 0x1p-40) + 0x1p-960};
    for (const auto i : in_order(tree)) {
        visitor.i = i;
        tree.findNeighbors(visitor, scene.centres[i].data(), parameters);
    }
}

}  // namespace

int main() {
    char version[16];
    std::snprintf(version, sizeof version, "%x.%x.%x", NANOFLANN_VERSION >> 8, NANOFLANN_VERSION >> 4 & 15, NANOFLANN_VERSION & 15);
    runner::serve("nanoflann", version, detect<2>, detect<3>);
}
