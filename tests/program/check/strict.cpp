// A runner that prints, and answers only if its reset and its hook were called for the scene.
#include "runner.hpp"
template <int D> struct Strict {
    bool fresh = false;
    std::size_t prepared = 0;
    void reset() { fresh = true; }
    void prepare(const runner::Scene<D>& scene) {
        std::puts("noise");
        std::cout << "noise" << std::endl;
        prepared = scene.centres.size();
    }
    void operator()(const runner::Scene<D>& scene, runner::Pairs& pairs) {
        if (!fresh) throw std::runtime_error("it was not reset");
        if (prepared != scene.centres.size()) throw std::runtime_error("it was not prepared");
        fresh = false;
        for (std::uint32_t i = 0; i < prepared; i++)
            for (std::uint32_t j = 0; j < i; j++)
                if (scene.touch(i, j)) pairs.push_back({i, j});
    }
};
int main() { runner::serve("strict", "1", Strict<2>{}, Strict<3>{}, "f64"); }
