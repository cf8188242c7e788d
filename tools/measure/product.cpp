// Cost of products of expansions [Ren2006] "Real-time soft shadows in dynamic scenes using spherical harmonic
// exponentiation".
#include "tools/measure/product.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"
#include "tools/measure/basis_signals.h"
#include "tools/measure/timing.h"

namespace prt::tools {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Rows that share no sets of the first cache.
constexpr size_t kBatch = 64, kStride = 80;

/// What the methods of one order work on.
struct Work {
    int shOrder;
    std::vector<float> f, g, out;  ///< structures of arrays; single products take the first values
    std::vector<float> matrix;

    explicit Work(int order)
        : shOrder(order), f(size_t(shCount(order)) * kStride), g(f.size()), out(f.size()) {
        SignalRandom random(3);
        for (std::vector<float>* factor : {&f, &g})
            for (float& value : *factor) value = float(random.normal());
        matrix = productMatrix(first(f), order, order);
    }
    std::span<const float> first(const std::vector<float>& values) const {
        return {values.data(), size_t(shCount(shOrder))};
    }
    std::span<float> firstOut() { return {out.data(), size_t(shCount(shOrder))}; }
};

struct Method {
    const char* name;
    ShProductMethod cost;
    bool batch;
    void (*run)(Work& work);
};
constexpr Method kMethods[] = {
    {"table", ShProductMethod::kTable, false,
     [](Work& w) { keepResult(shProduct(w.first(w.f), w.first(w.g), w.shOrder).data()); }},
    {"straight-line", ShProductMethod::kStraightLine, false,
     [](Work& w) { shProduct(w.shOrder, w.first(w.f), w.first(w.g), w.firstOut()); }},
    {"matrix", ShProductMethod::kMatrix, false,
     [](Work& w) { applyProductMatrix(w.matrix, w.first(w.g), w.firstOut()); }},
    {"matrix-build", ShProductMethod::kMatrixBuild, false,
     [](Work& w) { keepResult(productMatrix(w.first(w.f), w.shOrder, w.shOrder).data()); }},
    {"straight-line-batch", ShProductMethod::kStraightLine, true,
     [](Work& w) { shProductSoa(w.shOrder, w.f, w.g, w.out, kBatch, kStride); }},
    {"matrix-batch", ShProductMethod::kMatrix, true,
     [](Work& w) { applyProductMatrixSoa(w.matrix, w.shOrder, w.shOrder, w.g, w.out, kBatch, kStride); }},
};

std::vector<const Method*> methodsFor(const std::vector<std::string>& names, int order) {
    std::vector<const Method*> methods;
    for (const std::string& name : names) {
        const auto method = std::find_if(std::begin(kMethods), std::end(kMethods),
                                         [&](const Method& m) { return name == m.name; });
        PRT_CHECK(method != std::end(kMethods));
        if (method->cost != ShProductMethod::kStraightLine || order <= kMaxProductCodeOrder)
            methods.push_back(method);
    }
    return methods;
}

std::vector<double> timesOf(const std::vector<const Method*>& methods, int order, int rounds) {
    if (rounds == 0) return std::vector<double>(methods.size(), kNone);
    Work work(order);
    std::vector<TimedMethod> timed;
    for (const Method* method : methods)
        timed.push_back({method->name, method->batch ? kBatch : 1, [&work, method] {
                             method->run(work);
                             keepResult(work.out.data());
                         }});
    return timeMethods(timed, rounds);
}

}  // namespace

const std::vector<std::string>& productMethods() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> result;
        for (const Method& method : kMethods) result.emplace_back(method.name);
        return result;
    }();
    return names;
}

std::vector<ProductCost> productCosts(const ProductCostSettings& settings) {
    std::vector<ProductCost> costs;
    for (const int n : settings.shOrders) {
        const std::vector<const Method*> methods = methodsFor(settings.methods, n);
        const std::vector<double> ns = timesOf(methods, n, settings.rounds);
        double single = kNone;
        for (size_t m = 0; m < methods.size(); ++m)
            if (std::string(methods[m]->name) == "straight-line") single = ns[m];
        for (size_t m = 0; m < methods.size(); ++m) {
            const ShProductCost cost = shProductCost(methods[m]->cost, n);
            costs.push_back({n, methods[m]->name, ns[m], shProductNonZeros(n), cost.multiplications,
                             cost.additions, ns[m] / single});
        }
    }
    return costs;
}

}  // namespace prt::tools
