// A cell grid as a contact detector in C++17. runners/runner.hpp implements the runner protocol
// (docs/PROTOCOL.md).
//
//     g++ -std=c++17 -O2 -ffp-contract=off -I runners examples/my_detector.cpp -o my_detector
//     contactbench check --runner ./my_detector
//
// This detector promises the arithmetic f64. A fused multiply-add would round differently and
// change near contacts, so -ffp-contract=off forbids it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "runner.hpp"

// Put your own detector here, for D dimensions. The object keeps only buffers between calls, so it
// needs no reset().
template <int D> class Grid {
    using Cell = std::array<std::int64_t, D>;
    // The cell and the number of each particle, sorted by cell.
    std::vector<std::pair<Cell, std::uint32_t>> entries;

  public:
    void operator()(const runner::Scene<D>& scene, runner::Pairs& pairs) {
        const std::size_t n = scene.centres.size();
        std::array<double, D> low{}, high{};
        for (int k = 0; k < D; k++) {
            for (std::size_t i = 0; i < n; i++) {
                low[k] = i == 0 ? scene.centres[i][k] : std::min(low[k], scene.centres[i][k]);
                high[k] = i == 0 ? scene.centres[i][k] : std::max(high[k], scene.centres[i][k]);
            }
        }
        // Cells are slightly wider than the largest distance of touching particles, including
        // distances whose squares underflow, so that rounding never puts such particles two cells
        // apart. They are also so wide that cell numbers stay below 2^31, with rounding errors far
        // below 10^-6.
        double edge = scene.reach() * (1.0 + 1e-6) + 1e-150;
        for (int k = 0; k < D; k++) edge = std::max(edge, (high[k] - low[k]) / 1073741824.0);
        if (!std::isfinite(edge)) throw runner::Refusal("the extent of the scene, or a particle, is larger than the largest double; scale it down");
        entries.clear();
        for (std::size_t i = 0; i < n; i++) {
            Cell cell;
            for (int k = 0; k < D; k++) cell[k] = static_cast<std::int64_t>((scene.centres[i][k] - low[k]) / edge);
            entries.push_back({cell, static_cast<std::uint32_t>(i)});
        }
        std::sort(entries.begin(), entries.end());
        for (std::size_t at = 0; at < n; at++) {
            const auto& [cell, i] = entries[at];
            // Search rows of three cells along the last axis. Of two neighbouring cells, the
            // earlier one finds the pairs.
            for (int row = 0; row < (D == 2 ? 3 : 9); row++) {
                Cell first = cell;
                first[0] += row % 3 - 1;
                if (D == 3) first[1] += row / 3 - 1;
                Cell last = first;
                first[D - 1] -= 1, last[D - 1] += 1;
                if (last < cell) continue;
                auto next = std::lower_bound(entries.begin() + at + 1, entries.end(), std::make_pair(first, std::uint32_t{0}));
                for (; next != entries.end() && !(last < next->first); ++next) {
                    if (scene.touch(i, next->second)) pairs.push_back({i, next->second});
                }
            }
        }
    }
};

int main() { runner::serve("my-grid", "1.0", Grid<2>{}, Grid<3>{}, "f64"); }
