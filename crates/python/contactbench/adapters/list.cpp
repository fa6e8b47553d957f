// The neighbour list of vesin as a program; external.py describes its input and output.
#include <cstdio>
#include <vector>
#include <vesin.h>

int main() {
    size_t n;
    double box[3][3];
    int flags[3];
    VesinOptions options = {};
    bool read = scanf("%zu %lf", &n, &options.cutoff) == 2;
    for (int &flag : flags) read = read && scanf("%d", &flag) == 1;
    for (auto &vector : box)
        for (double &number : vector) read = read && scanf("%lf", &number) == 1;
    std::vector<double> x(read ? 3 * n + 3 : 3);
    for (size_t k = 0; read && k < 3 * n; k++) read = scanf("%lf", &x[k]) == 1;
    if (!read) return fprintf(stderr, "the input ends too early\n"), 2;

    options.full = options.return_shifts = true;
    bool periodic[3] = {flags[0] == 1, flags[1] == 1, flags[2] == 1};
    VesinNeighborList list;
    const char *error = nullptr;
    auto points = reinterpret_cast<const double(*)[3]>(x.data());
    if (vesin_neighbors(points, n, box, periodic, {VesinCPU, 0}, options, &list, &error))
        return fprintf(stderr, "%s\n", error), 1;
    for (size_t k = 0; k < list.length; k++)
        printf("%zu %zu %d %d %d\n", list.pairs[k][0], list.pairs[k][1], list.shifts[k][0],
               list.shifts[k][1], list.shifts[k][2]);
    vesin_free(&list);
}
