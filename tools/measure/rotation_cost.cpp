// Cost of rotations, beside Table 1 and Sec. 3.2 of [Krivanek2006] "Fast Approximation to Spherical Harmonic
// Rotation".
#include "tools/measure/rotation_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>

#include "precompute/base/check.h"
#include "precompute/math/hsh_rotation.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/math/sh_rotation_matrix.h"
#include "precompute/math/sh_rotation_soa.h"
#include "precompute/math/sh_rotation_taylor.h"
#include "tools/measure/basis_signals.h"
#include "tools/measure/rotation_hsh.h"
#include "tools/measure/timing.h"

namespace prt::tools {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Rows that share no sets of the first cache.
constexpr size_t kBatch = 64, kStride = 80;

int intermediateOrder(int n) { return std::min(2 * n, kMaxShOrder); }

/// What the methods of one order work on: rotations with β up to 90°, a vector each.
struct Work {
    int shOrder;
    std::vector<Mat3d> rotations;
    std::vector<float> soaRotations, vectors, turned;
    ShRotationMatrix matrix;
    std::unique_ptr<HshRotationThroughSh> throughSh;
    std::unique_ptr<HshRotationTable> table;

    Work(int order, bool hsh, int tabulatedAngles)
        : shOrder(order),
          rotations(drawRotations()),
          soaRotations(9 * kStride),
          vectors(size_t(shCount(order)) * kStride),
          turned(vectors.size()),
          matrix(rotations.front(), order) {
        for (size_t k = 0; k < kBatch; ++k)
            for (size_t i = 0; i < 9; ++i)
                soaRotations[i * kStride + k] = float(rotations[k](Eigen::Index(i / 3), Eigen::Index(i % 3)));
        SignalRandom random(2);
        for (float& value : vectors) value = float(random.normal());
        if (!hsh) return;
        throughSh = std::make_unique<HshRotationThroughSh>(order, intermediateOrder(order));
        table = std::make_unique<HshRotationTable>(order, tabulatedAngles);
    }

    std::span<const float> in() const { return {vectors.data(), size_t(shCount(shOrder))}; }
    std::span<float> out() { return {turned.data(), size_t(shCount(shOrder))}; }

  private:
    static std::vector<Mat3d> drawRotations() {
        SignalRandom random(1);
        const auto angle = [&](double range) { return range * random.uniform(); };
        std::vector<Mat3d> result;
        for (size_t k = 0; k < kBatch; ++k)
            result.push_back(rotationFromZyz({angle(3), angle(0.5 * std::numbers::pi), angle(3)}));
        return result;
    }
};

template <ShTaylorOrder kOrder>
void taylor(Work& w, const Mat3d& r) {
    rotateShTaylor(r, kOrder, w.shOrder, w.in(), w.out());
}
template <ShTaylorOrder kOrder>
void taylorBatch(Work& w, const Mat3d&) {
    rotateShTaylorSoa(w.soaRotations, kOrder, w.shOrder, kBatch, kStride, w.vectors, w.turned);
}

struct Method {
    const char* name;
    bool batch;
    void (*run)(Work& work, const Mat3d& rotation);
};
constexpr Method kMethods[] = {
    {"zxzxz", false, [](Work& w, const Mat3d& r) { rotateSh(r, w.shOrder, w.in(), w.out()); }},
    {"ivanic", false, [](Work& w, const Mat3d& r) { ShRotationMatrix(r, w.shOrder).apply(w.in(), w.out()); }},
    {"ivanic-apply", false, [](Work& w, const Mat3d&) { w.matrix.apply(w.in(), w.out()); }},
    {"taylor-1", false, taylor<ShTaylorOrder::One>},
    {"taylor-1.5", false, taylor<ShTaylorOrder::OneAndHalf>},
    {"taylor-2", false, taylor<ShTaylorOrder::Two>},
    {"zxzxz-batch", true,
     [](Work& w, const Mat3d&) {
         rotateShSoa(w.soaRotations, w.shOrder, kBatch, kStride, w.vectors, w.turned);
     }},
    {"taylor-1-batch", true, taylorBatch<ShTaylorOrder::One>},
    {"taylor-1.5-batch", true, taylorBatch<ShTaylorOrder::OneAndHalf>},
    {"taylor-2-batch", true, taylorBatch<ShTaylorOrder::Two>},
    {"one-zxzxz-batch", true,
     [](Work& w, const Mat3d&) {
         rotateShSoa(w.rotations[0], w.shOrder, kBatch, kStride, w.vectors, w.turned);
     }},
    {"one-matrix-batch", true,
     [](Work& w, const Mat3d&) { w.matrix.applySoa(kBatch, kStride, w.vectors, w.turned); }},
    {kHshThroughSh, false, [](Work& w, const Mat3d& r) { w.throughSh->rotate(r, w.in(), w.out()); }},
    {kHshDigonRemoval, false,
     [](Work& w, const Mat3d& r) { w.table->rotateByDigonRemoval(r, w.in(), w.out()); }},
    {kHshTable, false, [](Work& w, const Mat3d& r) { w.table->rotateByTable(r, w.in(), w.out()); }},
};

const Method& methodNamed(const std::string& name) {
    const auto found = std::find_if(std::begin(kMethods), std::end(kMethods),
                                    [&](const Method& m) { return name == m.name; });
    PRT_CHECK(found != std::end(kMethods));
    return *found;
}

std::vector<double> timesOf(const RotationCostSettings& settings, int order) {
    if (settings.rounds == 0) return std::vector<double>(settings.methods.size(), kNone);
    const bool hsh = std::any_of(settings.methods.begin(), settings.methods.end(),
                                 [](const std::string& name) { return name.starts_with("hsh-"); });
    Work work(order, hsh, settings.tabulatedAngles);
    std::vector<TimedMethod> timed;
    for (const std::string& name : settings.methods) {
        const Method& method = methodNamed(name);
        timed.push_back({name, kBatch, [&work, &method] {
                             const size_t calls = method.batch ? 1 : kBatch;
                             for (size_t k = 0; k < calls; ++k) {
                                 method.run(work, work.rotations[k]);
                                 keepResult(work.turned.data());
                             }
                         }});
    }
    return timeMethods(timed, settings.rounds);
}

/// Whether a constant factor takes a multiplication: 0 and ±1 do not.
bool isCostly(double factor) { return std::abs(factor) > 1e-11 && std::abs(std::abs(factor) - 1) > 1e-11; }

/// Entries of a block matrix that do.
double costlyEntries(const ShBandMatrix& matrix) {
    double count = 0;
    for (int l = 0; l < matrix.shOrder(); ++l)
        count += double(std::count_if(matrix.block(l).begin(), matrix.block(l).end(), isCostly));
    return count;
}

/// A turn about z: four multiplications for every pair of coefficients of ±m.
double zTurnMultiplications(int n) { return 2.0 * n * (n - 1); }

/// Three turns about z; two exchanges of y and z, which have the entries of a quarter turn about x but for
/// signs.
double zxzxzOurMultiplications(int n) {
    Mat3d quarter = Mat3d::Zero();
    quarter(0, 0) = quarter(2, 1) = 1;
    quarter(1, 2) = -1;
    return 3 * zTurnMultiplications(n) + 2 * costlyEntries(ShRotationMatrix(quarter, n));
}

/// Two turns about z, and by coefficient the series: β and β²/2 times what G and G² give, or 1 plus the
/// diagonal of G² times β²/2.
double taylorOurMultiplications(int n, double order) {
    const ShBandMatrix generator = shYRotationGenerator(n);
    double series = costlyEntries(generator) + n * n - 1;
    if (order == 2) series *= 2;
    for (int l = 1; order == 1.5 && l < n; ++l)
        for (int r = 0; r < 2 * l + 1; ++r) {
            const std::span<const double> row =
                generator.block(l).subspan(size_t(r * (2 * l + 1)), size_t(2 * l + 1));
            const double diagonal = std::inner_product(row.begin(), row.end(), row.begin(), 0.0);
            if (diagonal != 0) series += isCostly(diagonal) ? 2 : 1;
        }
    return 2 * zTurnMultiplications(n) + series;
}

/// A matrix per symmetry, between two tabulated ones.
double hshMatrixMultiplications(int n) {
    const double even = n * (n + 1) / 2, odd = n * (n - 1) / 2;
    return 2 * (even * even + odd * odd + even + odd);
}

double ourMultiplications(const std::string& method, int n) {
    if (method.starts_with("taylor-"))
        return taylorOurMultiplications(n, method.starts_with("taylor-1.5") ? 1.5 : method[7] == '1' ? 1 : 2);
    if (method == "ivanic") return kNone;
    if (method == "ivanic-apply" || method == "one-matrix-batch") return ivanicMultiplications(n);
    if (method == kHshThroughSh) {
        const int between = intermediateOrder(n);
        double conversion = 0;
        for (int m = 1 - n; m < n; ++m) conversion += double(n - std::abs(m)) * (between - std::abs(m));
        return 2 * conversion + zxzxzOurMultiplications(between);
    }
    if (method == kHshDigonRemoval)
        return zTurnMultiplications(n) + hshMatrixMultiplications(n) + zxzxzOurMultiplications(n);
    if (method == kHshTable) return 2 * zTurnMultiplications(n) + hshMatrixMultiplications(n);
    return zxzxzOurMultiplications(n);
}

double paperMultiplications(const std::string& method, int n) {
    if (method.find("zxzxz") != std::string::npos) return zxzxzMultiplications(n);
    if (method.starts_with("taylor-1.5")) return taylorMultiplications(n);
    if (method == "ivanic-apply" || method == "one-matrix-batch") return ivanicMultiplications(n);
    return kNone;
}

constexpr PublishedTime kPublished[] = {
    {"flamingo", "taylor-1.5", 6, 0.68}, {"flamingo", "taylor-1.5", 10, 1.54},
    {"flamingo", "zxzxz", 6, 2.96},      {"flamingo", "zxzxz", 10, 9.83},
    {"flamingo", "ivanic", 6, 10.1},     {"flamingo", "ivanic", 10, 49.1},
    {"flamingo", "directx", 6, 17.9},    {"sphere", "taylor-1.5", 6, 0.65},
    {"sphere", "taylor-1.5", 10, 1.44},  {"sphere", "zxzxz", 6, 2.51},
    {"sphere", "zxzxz", 10, 8.57},       {"sphere", "ivanic", 6, 9.63},
    {"sphere", "ivanic", 10, 47.8},      {"sphere", "directx", 6, 17.9}};

double publishedUs(const std::string& method, int n) {
    for (const PublishedTime& time : kPublished)
        if (std::string(time.scene) == "flamingo" && time.method == method && time.shOrder == n)
            return time.us;
    return kNone;
}

}  // namespace

const std::vector<std::string>& rotationMethods() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> result;
        for (const Method& method : kMethods) result.emplace_back(method.name);
        return result;
    }();
    return names;
}

std::vector<RotationCost> rotationCosts(const RotationCostSettings& settings) {
    const auto zxzxz = std::find(settings.methods.begin(), settings.methods.end(), "zxzxz");
    std::vector<RotationCost> costs;
    for (const int n : settings.shOrders) {
        const std::vector<double> ns = timesOf(settings, n);
        const double reference =
            zxzxz == settings.methods.end() ? kNone : ns[size_t(zxzxz - settings.methods.begin())];
        for (size_t m = 0; m < settings.methods.size(); ++m) {
            const std::string& method = settings.methods[m];
            costs.push_back({n, method, ns[m], ourMultiplications(method, n), paperMultiplications(method, n),
                             ns[m] / reference, publishedUs(method, n)});
        }
    }
    return costs;
}

std::span<const PublishedTime> publishedRotationTimes() { return kPublished; }

}  // namespace prt::tools
