// Straight-line evaluation of bases with few functions, after [HabelWimmer2010, Sec. 4.2 and 5]: the number
// type is double for tests, float for timing, and one that counts for the number of operations.
#include "tools/measure/basis_cost.h"

#include <array>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/directions.h"
#include "tools/measure/timing.h"

namespace prt::tools {
namespace {

struct Counts {
    int additions = 0, multiplications = 0, divisions = 0, squareRoots = 0;
};

/// A number that counts what is done with it.
struct Counted {
    double value = 0;
    static inline thread_local Counts counts;

    Counted() = default;
    explicit Counted(double v) : value(v) {}
    Counted operator-() const { return Counted(-value); }  // signs are free: they go into the constants
};
Counted operator+(const Counted& a, const Counted& b) {
    ++Counted::counts.additions;
    return Counted(a.value + b.value);
}
Counted operator-(const Counted& a, const Counted& b) {
    ++Counted::counts.additions;
    return Counted(a.value - b.value);
}
Counted operator*(const Counted& a, const Counted& b) {
    ++Counted::counts.multiplications;
    return Counted(a.value * b.value);
}
Counted operator/(const Counted& a, const Counted& b) {
    ++Counted::counts.divisions;
    return Counted(a.value / b.value);
}
Counted sqrt(const Counted& a) {
    ++Counted::counts.squareRoots;
    return Counted(std::sqrt(a.value));
}

using std::numbers::pi;
/// √(a/π), the factor of nearly everything.
template <typename T>
T overPi(double a) {
    return T(std::sqrt(a / pi));
}

template <typename T>
void halfLife2(T x, T y, T z, T* out) {
    const T a(0.5 / std::sqrt(pi)), b(std::sqrt(0.75 / pi)), c(std::sqrt(0.5 / pi));
    const T shared = c * z - a * x, side = b * y;
    out[0] = shared - side;
    out[1] = shared + side;
    out[2] = overPi<T>(1) * x + c * z;
}

/// [HabelWimmer2010, Eqs. 8-13]
template <typename T, int Order>
void habel(T x, T y, T z, T* out) {
    const T linear = overPi<T>(1.5);
    out[0] = overPi<T>(0.5);
    out[1] = -linear * y;
    out[2] = overPi<T>(6) * z - linear;
    out[3] = -linear * x;
    if constexpr (Order == 3) {
        out[4] = overPi<T>(7.5) * (x * y);
        out[5] = overPi<T>(1.875) * (x * x - y * y);
    }
}

/// Spherical harmonics times `scale`.
template <typename T, int Order>
void spherical(T x, T y, T z, T* out, double scale) {
    const double s = scale * scale;
    out[0] = overPi<T>(0.25 * s);
    out[1] = -overPi<T>(0.75 * s) * y;
    out[2] = overPi<T>(0.75 * s) * z;
    out[3] = -overPi<T>(0.75 * s) * x;
    if constexpr (Order == 3) {
        const T mixed = overPi<T>(3.75 * s);
        out[4] = mixed * (x * y);
        out[5] = -mixed * (y * z);
        out[6] = overPi<T>(2.8125 * s) * (z * z) - overPi<T>(0.3125 * s);
        out[7] = -mixed * (x * z);
        out[8] = overPi<T>(0.9375 * s) * (x * x - y * y);
    }
}

template <typename T, int Order>
void evenReflection(T x, T y, T z, T* out) {
    out[0] = overPi<T>(0.5);
    out[1] = -overPi<T>(1.5) * y;
    out[2] = -overPi<T>(1.5) * x;
    if constexpr (Order == 3) {
        out[3] = overPi<T>(7.5) * (x * y);
        out[4] = overPi<T>(5.625) * (z * z) - overPi<T>(0.625);
        out[5] = overPi<T>(1.875) * (x * x - y * y);
    }
}

/// (x, y)·2√(z/(1 + z)) and 2z − 1 are where the shifted polynomials live.
template <typename T, int Order>
void hemispherical(T x, T y, T z, T* out) {
    using std::sqrt;
    const T scale = T(2) * sqrt(z / (T(1) + z));
    spherical<T, Order>(x * scale, y * scale, T(2) * z - T(1), out, std::numbers::sqrt2);
}

template <typename T, int Order>
void makhotkin(T x, T y, T z, T* out) {
    using std::sqrt;
    const T scale = sqrt(z / (T(1) + z)), u = x * scale, v = y * scale;
    out[0] = overPi<T>(1);
    out[1] = -overPi<T>(12) * v;
    out[2] = overPi<T>(18) * z - overPi<T>(8);
    out[3] = -overPi<T>(12) * u;
    if constexpr (Order == 3) {
        const T tilted = overPi<T>(108) - overPi<T>(300) * z;  // sign of odd m
        out[4] = overPi<T>(240) * (u * v);
        out[5] = tilted * v;
        out[6] = z * (overPi<T>(300) * z - overPi<T>(432)) + overPi<T>(27);
        out[7] = tilted * u;
        out[8] = overPi<T>(60) * (u * u - v * v);
    }
}

/// On the disc of radius r = √2 sin(θ/2) = √(1 − z).
template <typename T, int Order>
void zernike(T x, T y, T z, T* out) {
    using std::sqrt;
    const T scale = T(1) / sqrt(T(1) + z), u = x * scale, v = y * scale;
    out[0] = overPi<T>(0.5);
    out[1] = overPi<T>(2) * v;
    out[2] = overPi<T>(2) * u;
    if constexpr (Order >= 3) {
        out[3] = overPi<T>(12) * (u * v);
        out[4] = overPi<T>(1.5) - overPi<T>(6) * z;
        out[5] = overPi<T>(3) * (u * u - v * v);
    }
    if constexpr (Order == 4) {
        const T uu = u * u, vv = v * v, radial = overPi<T>(4) - overPi<T>(36) * z;
        out[6] = overPi<T>(4) * v * (T(3) * uu - vv);
        out[7] = radial * v;
        out[8] = radial * u;
        out[9] = overPi<T>(4) * u * (uu - T(3) * vv);
    }
}

template <typename T, int Order>
void plain(T x, T y, T z, T* out) {
    spherical<T, Order>(x, y, z, out, 1);
}

/// A function as a type, so that the compiler sees through it.
template <typename T, int Count, void (*Function)(T, T, T, T*)>
struct Code {
    static constexpr int kCount = Count;
    void operator()(T x, T y, T z, T* out) const { Function(x, y, z, out); }
};

/// Calls use(code) with the Code of a basis for the number type T.
template <typename T, typename Use>
void withStraightLine(const std::string& basis, int order, const Use& use) {
    if (basis == "hl2") return use(Code<T, 3, halfLife2<T>>());
    if (basis == "h") return order == 2 ? use(Code<T, 4, habel<T, 2>>()) : use(Code<T, 6, habel<T, 3>>());
    if (basis == "sh") return order == 2 ? use(Code<T, 4, plain<T, 2>>()) : use(Code<T, 9, plain<T, 3>>());
    if (basis == "esh")
        return order == 2 ? use(Code<T, 3, evenReflection<T, 2>>()) : use(Code<T, 6, evenReflection<T, 3>>());
    if (basis == "hsh")
        return order == 2 ? use(Code<T, 4, hemispherical<T, 2>>()) : use(Code<T, 9, hemispherical<T, 3>>());
    if (basis == "makhotkin")
        return order == 2 ? use(Code<T, 4, makhotkin<T, 2>>()) : use(Code<T, 9, makhotkin<T, 3>>());
    PRT_CHECK(basis == "zernike");
    if (order == 2) return use(Code<T, 3, zernike<T, 2>>());
    return order == 3 ? use(Code<T, 6, zernike<T, 3>>()) : use(Code<T, 10, zernike<T, 4>>());
}

struct Listed {
    const char* basis;
    int order;
};
constexpr Listed kListed[] = {{"hl2", 2}, {"zernike", 2},   {"esh", 2},       {"h", 2},       {"sh", 2},
                              {"hsh", 2}, {"makhotkin", 2}, {"h", 3},         {"zernike", 3}, {"esh", 3},
                              {"sh", 3},  {"hsh", 3},       {"makhotkin", 3}, {"zernike", 4}};

EvaluationCost countOperations(const Listed& listed) {
    EvaluationCost cost{listed.basis, listed.order, 0, 0, 0, 0, 0, 0};
    withStraightLine<Counted>(listed.basis, listed.order, [&](auto code) {
        Counted out[10];
        Counted::counts = {};
        code(Counted(0.48), Counted(0.6), Counted(0.64), out);
        Counted sum = out[0] * Counted(1);
        for (int i = 1; i < code.kCount; ++i) sum = sum + out[i] * Counted(1);
        cost.coefficients = code.kCount;
    });
    const Counts& counts = Counted::counts;
    cost.additions = counts.additions;
    cost.multiplications = counts.multiplications;
    cost.divisions = counts.divisions;
    cost.squareRoots = counts.squareRoots;
    return cost;
}

}  // namespace

void evalStraightLine(const std::string& basis, int order, const Vec3d& direction, std::span<double> out) {
    withStraightLine<double>(basis, order, [&](auto code) {
        PRT_CHECK_EQ(out.size(), size_t(code.kCount));
        code(direction.x(), direction.y(), direction.z(), out.data());
    });
}

std::vector<EvaluationCost> evaluationCosts(bool timed) {
    std::vector<EvaluationCost> costs;
    for (const Listed& listed : kListed) costs.push_back(countOperations(listed));
    if (!timed) return costs;
    std::vector<Vec3f> directions = randomDirections(512, 1);
    for (Vec3f& direction : directions) direction.z() = std::abs(direction.z());
    std::array<float, 10> coefficients;
    for (size_t i = 0; i < coefficients.size(); ++i) coefficients[i] = 1.0f / float(1 + i);
    std::vector<TimedMethod> methods;
    for (const Listed& listed : kListed)
        withStraightLine<float>(listed.basis, listed.order, [&](auto code) {
            methods.push_back({listed.basis, directions.size(), [&directions, &coefficients, code] {
                                   for (const Vec3f& d : directions) {
                                       float out[10], sum = 0;
                                       code(d.x(), d.y(), d.z(), out);
                                       for (int i = 0; i < decltype(code)::kCount; ++i)
                                           sum += coefficients[size_t(i)] * out[i];
                                       keepResult(&sum);
                                   }
                               }});
        });
    const std::vector<double> ns = timeMethods(methods);
    for (size_t i = 0; i < costs.size(); ++i) costs[i].ns = ns[i];
    return costs;
}

}  // namespace prt::tools
