// The runner protocol (docs/PROTOCOL.md) for detectors in C++17. A detector is a function from a
// scene to a list of pairs in a reused buffer: include this file, write the function and pass it to
// `serve`, as `examples/my_detector.cpp` does.
//
// If a detector keeps more than buffers between detections, it needs a member function `reset()`
// that drops the rest: a sample is a number of passes over the trajectory, and each begins with a
// reset. These runners support trajectories of one frame only (`at_rest`); contactbench sends them
// the frames of a motion one by one.
//
// A member function `prepare(scene)` is called once per scene, before the clock starts, for work
// that does not depend on coordinates. Replies go to a descriptor of their own, so whatever the
// library prints on standard output appears on standard error.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>
#ifdef _WIN32
#include <io.h>
#else
#include <unistd.h>
#endif

namespace runner {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// Throw this if a detection does not support the scene: one sentence with numbers and remedy.
struct Refusal : std::runtime_error {
    using std::runtime_error::runtime_error;
};

template <int D> struct Scene {
    std::vector<std::array<double, D>> centres;
    // One radius for all, or one per particle.
    std::vector<double> radii;

    double radius(std::size_t i) const { return radii.size() == 1 ? radii[0] : radii[i]; }
    // The largest distance at which two particles touch.
    double reach() const { return radii.empty() ? 0.0 : 2.0 * *std::max_element(radii.begin(), radii.end()); }
    // Decides in f64, summing in the order of the axes.
    bool touch(std::size_t i, std::size_t j) const {
        double square = 0.0;
        for (int k = 0; k < D; k++) square += (centres[i][k] - centres[j][k]) * (centres[i][k] - centres[j][k]);
        const double sum = radius(i) + radius(j);
        return square <= sum * sum;
    }
};

// Returns where the value of a field begins; npos if the field is missing.
inline std::size_t value_of(const std::string& line, const std::string& name) {
    auto at = line.find("\"" + name + "\":");
    if (at == std::string::npos) return at;
    at += name.size() + 3;
    while (at < line.size() && line[at] == ' ') at++;
    return at;
}

// Reads the string whose opening quote is at `at`, undoes backslashes, and moves `at` behind it.
inline std::string quoted(const std::string& line, std::size_t& at) {
    std::string value;
    for (at++; at < line.size() && line[at] != '"'; at++) {
        if (line[at] == '\\' && at + 1 < line.size()) at++;
        value += line[at];
    }
    at++;
    return value;
}

// Returns the value of a field as text, strings without quotes; empty if the field is missing.
inline std::string field(const std::string& line, const std::string& name) {
    auto at = value_of(line, name);
    if (at == std::string::npos) return "";
    if (at >= line.size() || line[at] != '"') return line.substr(at, line.find_first_of(",}", at) - at);
    return quoted(line, at);
}

inline std::vector<std::string> strings(const std::string& line, const std::string& name) {
    std::vector<std::string> values;
    auto at = value_of(line, name);
    while (at < line.size() && line[at] != ']') {
        if (line[at] == '"') values.push_back(quoted(line, at));
        else at++;
    }
    return values;
}

inline std::string escaped(const std::string& text) {
    std::string out;
    for (char c : text) out += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c < ' ' ? ' ' : c};
    return out;
}

// The file for replies.
inline std::FILE*& channel() {
    static std::FILE* file = stdout;
    return file;
}

// Reserves standard output for the protocol: replies go to a copy of it, and descriptor 1 becomes
// standard error.
inline void own_channel() {
    std::fflush(stdout);
#ifdef _WIN32
    const int copy = _dup(1);
    std::FILE* file = copy < 0 ? nullptr : _fdopen(copy, "w");
    if (file && _dup2(2, 1) == 0) channel() = file;
#else
    const int copy = dup(1);
    std::FILE* file = copy < 0 ? nullptr : fdopen(copy, "w");
    if (file && dup2(2, 1) == 1) channel() = file;
#endif
}

inline void say(const std::string& reply) {
    std::fputs((reply + "\n").c_str(), channel());
    std::fflush(channel());
}

inline std::vector<double> numbers(const std::string& path, std::size_t count) {
    std::ifstream file(path, std::ios::binary);
    char head[10];
    if (!file.read(head, 10) || std::memcmp(head, "\x93NUMPY\x01", 7) != 0) throw std::runtime_error(path + " is not an npy file, version 1");
    file.seekg(10 + static_cast<unsigned char>(head[8]) + 256 * static_cast<unsigned char>(head[9]));
    std::vector<double> data(count);
    if (!file.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(count * sizeof(double)))) throw std::runtime_error(path + " is cut off");
    return data;
}

template <int D> Scene<D> load(const std::string& line) {
    Scene<D> scene;
    const std::size_t n = std::stoull(field(line, "n"));
    const std::string radius = field(line, "radius");
    const auto frames = strings(line, "frames");
    if (frames.size() != 1)
        throw Refusal("this runner supports trajectories of one frame; this one has " + std::to_string(frames.size()));
    if (value_of(line, "box") != std::string::npos) throw Refusal("this detector supports open space only, and the scene has a periodic box");
    const bool each = radius == "null";
    const auto data = numbers(frames[0], n * (D + each));
    scene.centres.resize(n);
    // stod would throw for subnormal numbers.
    if (!each) scene.radii = {std::strtod(radius.c_str(), nullptr)};
    for (std::size_t i = 0; i < n; i++) {
        const double* row = &data[i * (D + each)];
        std::copy(row, row + D, scene.centres[i].begin());
        if (each) scene.radii.push_back(row[D]);
    }
    return scene;
}

inline std::string digest(const Pairs& pairs) {
    std::uint64_t sum = 0;
    for (auto [i, j] : pairs) {
        std::uint64_t z = (static_cast<std::uint64_t>(std::min(i, j)) << 32 | std::max(i, j)) + 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        sum += z ^ (z >> 31);
    }
    char text[80];
    std::snprintf(text, sizeof text, "\"contacts\":%zu,\"digest\":\"0x%016llx\"", pairs.size(), static_cast<unsigned long long>(sum));
    return text;
}

inline void write(const std::string& path, const Pairs& pairs) {
    std::string head = "{'descr': '<u4', 'fortran_order': False, 'shape': (" + std::to_string(pairs.size()) + ", 2), }";
    while ((10 + head.size() + 1) % 64 != 0) head += ' ';
    head += '\n';
    std::ofstream file(path, std::ios::binary);
    file.write("\x93NUMPY\x01\x00", 8);
    file.put(static_cast<char>(head.size() % 256)).put(static_cast<char>(head.size() / 256)) << head;
    file.write(reinterpret_cast<const char*>(pairs.data()), static_cast<std::streamsize>(pairs.size() * 8));
    if (!file) throw std::runtime_error("cannot write " + path);
}

// Calls the member function `reset`, if there is one.
template <class Detect> auto reset(Detect& detect, int) -> decltype(detect.reset()) { return detect.reset(); }
template <class Detect> void reset(Detect&, long) {}

// Calls the member function `prepare`, if there is one.
template <class Detect, class Scene> auto prepare(Detect& detect, const Scene& scene, int) -> decltype(detect.prepare(scene)) { return detect.prepare(scene); }
template <class Detect, class Scene> void prepare(Detect&, const Scene&, long) {}

// Returns the nanoseconds of this many passes.
template <int D, class Detect> std::uint64_t timed(Detect& detect, const Scene<D>& scene, std::uint64_t passes, Pairs& pairs) {
    const auto start = std::chrono::steady_clock::now();
    for (std::uint64_t k = 0; k < passes; k++) {
        pairs.clear();
        reset(detect, 0);
        detect(scene, pairs);
    }
    return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start).count());
}

// The compiler, and the widest instruction set that it may use.
#if defined(__clang__)
inline const std::string compiler = "clang " __clang_version__;
#elif defined(__GNUC__)
inline const std::string compiler = "gcc " __VERSION__;
#else
inline const std::string compiler = "unknown";
#endif
#if defined(__AVX512F__)
inline const std::string level = "avx512";
#elif defined(__AVX2__)
inline const std::string level = "avx2";
#else
inline const std::string level = "portable";
#endif

// Answers requests until `quit`. `Plane` and `Space` are called with a scene and a cleared list of
// pairs, for one detection from raw coordinates. `arithmetic` is the one in which the answers are
// right: `exact`, `f64` (as `Scene::touch` decides), `textbook` or `f32`.
template <class Plane, class Space>
void serve(const std::string& name, const std::string& version, Plane plane, Space space, const std::string& arithmetic = "exact") {
    std::ios::sync_with_stdio(false);
    own_channel();
    say("{\"reply\":\"hello\",\"protocol\":4,\"detector\":\"" + name + "\",\"arithmetic\":\"" + arithmetic + "\",\"version\":\"" + version +
        "\",\"build\":{\"compiler\":\"" + compiler + "\",\"level\":\"" + level + "\"},\"at_rest\":true}");
    std::optional<Scene<2>> flat;
    std::optional<Scene<3>> solid;
    std::uint64_t calls = 0;
    Pairs pairs;
    const auto detect = [&](std::uint64_t times) { return flat ? timed(plane, *flat, times, pairs) : timed(space, *solid, times, pairs); };
    for (std::string line; std::getline(std::cin, line);) {
        const std::string asked = field(line, "request");
        try {
            if (asked == "quit") return;
            if (asked == "load") {
                flat.reset(), solid.reset(), calls = 0;
                if (field(line, "dim") == "2") flat = load<2>(line);
                else solid = load<3>(line);
                if (flat) prepare(plane, *flat, 0);
                else prepare(space, *solid, 0);
                say("{\"reply\":\"loaded\"}");
            } else if (asked == "count" || asked == "memory") {
                say("{\"reply\":\"unsupported\"}");
            } else if (!flat && !solid) {
                say("{\"reply\":\"error\",\"reason\":\"no scene is loaded; send load first\"}");
            } else if (asked == "sample") {
                const std::uint64_t first = std::max<std::uint64_t>(detect(1), 1);
                const bool fresh = calls == 0;
                const std::uint64_t least = std::stoull(field(line, "min_ns"));
                if (fresh) {
                    calls = 1;
                    for (std::uint64_t took; (took = detect(calls)) < least;)
                        calls = std::max(calls + 1, std::min(10 * calls, least * calls / std::max<std::uint64_t>(took, 1) * 9 / 8));
                }
                std::uint64_t took = detect(calls);
                // A disturbed calibration may yield too few detections.
                while (fresh && took < least / 2) {
                    calls = std::min(10 * calls, std::max(calls + 1, least * calls / std::max<std::uint64_t>(took, 1)));
                    took = detect(calls);
                }
                const std::uint64_t each = (took + calls / 2) / calls;
                std::ostringstream reply;
                reply << "{\"reply\":\"sample\",\"time_ns\":" << each << ",\"calls\":" << calls << ",\"elapsed_ns\":" << took << ",\"step_ns\":[" << each << "],\"first_ns\":" << first << "," << digest(pairs) << "}";
                say(reply.str());
            } else if (asked == "pairs") {
                detect(1);
                write(field(line, "path"), pairs);
                say("{\"reply\":\"pairs\",\"contacts\":" + std::to_string(pairs.size()) + "}");
            } else {
                say("{\"reply\":\"error\",\"reason\":\"there is no request '" + escaped(asked) + "'\"}");
            }
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const Refusal& refusal) {
            say("{\"reply\":\"refused\",\"reason\":\"" + escaped(refusal.what()) + "\"}");
        } catch (const std::exception& error) {
            say("{\"reply\":\"error\",\"reason\":\"" + escaped(error.what()) + "\"}");
        }
    }
}

}  // namespace runner
