// Sources: none; runs runtime/reference over rows of the picture.
#include "tools/view/reference.h"

#include <algorithm>
#include <exception>
#include <thread>
#include <utility>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "runtime/reference/reference.h"

namespace prt::tools {
namespace {

// Rows traced between two looks at the world; of whole tiles of the reference.
constexpr int kRows = 32;

struct Stopped {};

SurfaceImage rowsOf(const SurfaceImage& image, int first, int rows) {
    SurfaceImage part;
    part.width = image.width;
    part.height = rows;
    const auto cut = [&](const auto& from, auto& to) {
        const auto begin = from.begin() + std::ptrdiff_t(first) * image.width;
        to.assign(begin, begin + std::ptrdiff_t(rows) * image.width);
    };
    cut(image.triangle, part.triangle);
    cut(image.position, part.position);
    cut(image.geometricNormal, part.geometricNormal);
    cut(image.shadingNormal, part.shadingNormal);
    cut(image.albedo, part.albedo);
    return part;
}

}  // namespace

bool ReferencePicture::covers(std::span<const double> weights) const {
    for (size_t e = 0; e < weights.size(); ++e)
        if (weights[e] > 0 && !std::ranges::binary_search(environments, e)) return false;
    return true;
}

std::vector<float> TracedReference::blend(std::span<const double> weights) const {
    PRT_CHECK(picture.covers(weights));
    std::vector<float> sum(surface.pixels() * 3, 0.0f);
    for (size_t i = 0; i < irradiance.size(); ++i) {
        const float weight = float(weights[picture.environments[i]]);
        if (weight == 0) continue;
        for (size_t v = 0; v < sum.size(); ++v) sum[v] += weight * irradiance[i][v];
    }
    return sum;
}

struct ReferenceTracer::Job {
    TracedReference traced;
    std::atomic<bool> stop{false}, finished{false};
    std::atomic<int> rows{0};
    std::exception_ptr error;
    std::thread thread;

    ~Job() {
        stop = true;
        if (thread.joinable()) thread.join();
    }
};

ReferenceTracer::ReferenceTracer(const RayCaster& caster, const std::vector<Environment>& environments,
                                 int rays, std::function<void()> wake)
    : caster_(caster), environments_(environments), rays_(rays), wake_(std::move(wake)) {}

ReferenceTracer::~ReferenceTracer() = default;

void ReferenceTracer::run(Job& job, const RayCaster& caster, const std::vector<Environment>& environments,
                          int rays, const std::function<void()>& wake) {
    TracedReference& traced = job.traced;
    std::vector<Environment> shining;
    for (const size_t e : traced.picture.environments) shining.push_back(environments[e]);
    const std::vector<double> turns(shining.size(), traced.picture.rotationRad);
    const ReferenceDirections directions = makeReferenceDirections(shining, turns, rays);
    const SurfaceImage& surface = traced.surface;
    traced.irradiance.assign(shining.size(), std::vector<float>(surface.pixels() * 3, 0.0f));
    const auto lookUp = [&](size_t, std::span<const uint8_t>) {
        if (job.stop) throw Stopped{};
    };
    for (int first = 0; first < surface.height; first += kRows) {
        if (job.stop) throw Stopped{};
        const int rows = std::min(kRows, surface.height - first);
        const auto part = traceReference(caster, rowsOf(surface, first, rows), directions, lookUp);
        for (size_t e = 0; e < part.size(); ++e)
            std::ranges::copy(part[e],
                              traced.irradiance[e].begin() + std::ptrdiff_t(first) * surface.width * 3);
        job.rows = first + rows;
        if (wake) wake();
    }
}

void ReferenceTracer::start(const ReferencePicture& picture, const std::function<SurfaceImage()>& surface) {
    if (job_ && job_->traced.picture == picture) return;
    if (result_ && result_->picture == picture) return stop();
    stop();
    job_ = std::make_unique<Job>();
    job_->traced.picture = picture;
    job_->traced.surface = surface();
    PRT_CHECK_EQ(job_->traced.surface.pixels(), size_t(picture.width) * size_t(picture.height));
    job_->thread = std::thread(
        [job = job_.get(), &caster = caster_, &environments = environments_, rays = rays_, wake = wake_] {
            try {
                run(*job, caster, environments, rays, wake);
            } catch (const Stopped&) {
                job->stop = true;
            } catch (const Interrupted&) {
                job->stop = true;  // the main thread notices by itself
            } catch (...) {
                job->error = std::current_exception();
            }
            job->finished = true;
            if (wake) wake();
        });
}

void ReferenceTracer::stop() {
    // Not waited for: it ends within a tile.
    if (job_) {
        job_->stop = true;
        stopping_.push_back(std::move(job_));
    }
    std::erase_if(stopping_, [](const std::unique_ptr<Job>& job) { return job->finished.load(); });
}

bool ReferenceTracer::poll() {
    std::erase_if(stopping_, [](const std::unique_ptr<Job>& job) { return job->finished.load(); });
    if (!job_ || !job_->finished) return false;
    const std::unique_ptr<Job> job = std::move(job_);
    job->thread.join();
    if (job->error) std::rethrow_exception(job->error);
    if (job->stop) return false;
    result_ = std::make_unique<TracedReference>(std::move(job->traced));
    return true;
}

const ReferencePicture* ReferenceTracer::underWay() const { return job_ ? &job_->traced.picture : nullptr; }

double ReferenceTracer::progress() const {
    return job_ ? double(job_->rows) / std::max(1, job_->traced.picture.height) : 0;
}

}  // namespace prt::tools
