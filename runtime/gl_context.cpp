// Sources: OpenGL 4.5 core profile, sections 2.3.1 (errors) and 2.3.2 (reset); the interfaces to the window
// system are in gl_context_*.cpp.
#include "runtime/gl_context.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "precompute/base/check.h"
#include "runtime/gl_backend.h"
#include "runtime/gl_debug.h"
#include "runtime/gl_functions.h"

namespace prt {
namespace {

// OSMesa and Mesa's EGL keep one note between them of which context a thread draws into, and EGL does not see
// OSMesa change it: whoever is followed by the other kind is released first.
thread_local const GlBackend* lastCurrent = nullptr;

const char* text(const GlFunctions& gl, GLenum what) {
    const auto* bytes = gl.GetString(what);
    return bytes ? reinterpret_cast<const char*>(bytes) : "unknown";
}

// Before any other function is asked for: some interfaces answer any name.
void checkVersion(const GlBackend& backend) {
    const auto getString = reinterpret_cast<PFNGLGETSTRINGPROC>(backend.proc("glGetString"));
    const auto* version = getString ? reinterpret_cast<const char*>(getString(GL_VERSION)) : nullptr;
    if (!version)
        throw InputError("OpenGL", "no context is current on this thread", "make one current first");
    int major = 0, minor = 0;
    if (std::sscanf(version, "%d.%d", &major, &minor) != 2 || major * 10 + minor < 45)
        throw InputError("OpenGL",
                         fmt::format("version {} of {} is too old", version,
                                     reinterpret_cast<const char*>(getString(GL_RENDERER))),
                         "OpenGL 4.5 is needed (Mesa 22.3 has it, as in Debian 12)");
}

}  // namespace

#ifndef PRT_WITH_VIEWER
std::unique_ptr<GlBackend> makeWindowBackend(const GlWindowOptions&, bool) {
    throw InputError("OpenGL", "this build makes no windows", "build with -DPRT_WITH_VIEWER=ON");
}
#endif

const char* glContextKindName(GlContextKind kind) {
    switch (kind) {
        case GlContextKind::OsMesa:
            return "osmesa";
        case GlContextKind::Egl:
            return "egl";
        case GlContextKind::Window:
            return "window";
        case GlContextKind::Current:
            break;
    }
    return "current";
}

void* openGlLibrary(const char* variable, std::initializer_list<const char*> names, const char* remedy) {
    // RTLD_LOCAL keeps OpenGL's symbols away from any other OpenGL in the process. Never closed: LLVM inside
    // does not survive that.
    constexpr int kHow = RTLD_NOW | RTLD_LOCAL;
    const char* named = std::getenv(variable);
    const bool chosen = named && *named;
    std::string first;
    for (const char* name : names) {
        if (void* library = ::dlopen(chosen ? named : name, kHow)) return library;
        const char* why = ::dlerror();
        if (first.empty()) first = why ? why : "unknown reason";
        if (chosen) break;
    }
    throw InputError("OpenGL", fmt::format("{} cannot be loaded: {}", chosen ? named : *names.begin(), first),
                     chosen ? fmt::format("correct {}, or leave it unset", variable) : std::string(remedy));
}

GlProc glLibrarySymbol(void* library, const char* libraryName, const char* name, const char* remedy) {
    const auto symbol = reinterpret_cast<GlProc>(::dlsym(library, name));
    if (!symbol) throw InputError("OpenGL", fmt::format("{} has no function {}", libraryName, name), remedy);
    return symbol;
}

GlFunctions loadGlFunctions(const std::function<GlProc(const char* name)>& getProc) {
    GlFunctions gl;
    const char* missing = nullptr;
#define PRT_GL_RESOLVE(type, name)                         \
    gl.name = reinterpret_cast<type>(getProc("gl" #name)); \
    if (!gl.name && !missing) missing = "gl" #name;
    PRT_GL_FUNCTIONS(PRT_GL_RESOLVE)
#undef PRT_GL_RESOLVE
    if (missing)
        throw InputError("OpenGL", std::string("the driver has no function ") + missing,
                         "OpenGL 4.5 is needed");
    return gl;
}

struct GlContext::State {
    GlMessages messages;  // outlives the context, which may still speak while it goes
    std::unique_ptr<GlBackend> backend;
    GlFunctions gl;

    ~State() {
        if (lastCurrent == backend.get()) lastCurrent = nullptr;
    }
};

GlContext::GlContext(std::unique_ptr<State> state) : state_(std::move(state)) {
    makeCurrent();
    const GlBackend& backend = *state_->backend;
    checkVersion(backend);
    state_->gl = loadGlFunctions([&](const char* name) { return backend.proc(name); });
}

GlContext::GlContext(GlContextKind kind)
    : GlContext([kind] {
          PRT_CHECK(kind == GlContextKind::OsMesa || kind == GlContextKind::Egl);
          auto state = std::make_unique<State>();
          state->backend = kind == GlContextKind::Egl ? makeEglBackend(glDebugWanted()) : makeOsMesaBackend();
          return state;
      }()) {
    listen();
}

GlContext::GlContext(const GlWindowOptions& options)
    : GlContext([&options] {
          auto state = std::make_unique<State>();
          state->backend = makeWindowBackend(options, glDebugWanted());
          return state;
      }()) {
    listen();
}

void GlContext::listen() {
    state_->messages.listen(gl(), glDebugWanted());
    check("creating the context");
}

GlContext GlContext::ofCaller(GlGetProc getProc) {
    auto state = std::make_unique<State>();
    state->backend = makeCallerBackend(getProc);
    return GlContext(std::move(state));
}

GlContext::~GlContext() = default;

GlContextKind GlContext::kind() const { return state_->backend->kind(); }

const GlFunctions& GlContext::gl() const { return state_->gl; }

void* GlContext::window() const { return state_->backend->window(); }

std::string GlContext::rendererName() const {
    makeCurrent();
    return text(gl(), GL_RENDERER);
}

std::string GlContext::versionName() const {
    makeCurrent();
    return text(gl(), GL_VERSION);
}

void GlContext::makeCurrent() const {
    const GlBackend& wanted = *state_->backend;
    if (wanted.kind() != GlContextKind::Current && lastCurrent && lastCurrent != &wanted &&
        lastCurrent->kind() != wanted.kind() && lastCurrent->isCurrent())
        lastCurrent->release();
    if (!wanted.isCurrent()) wanted.makeCurrent();
    lastCurrent = &wanted;
}

void GlContext::check(const std::string& doing) const {
    GLenum first = GL_NO_ERROR;
    // Bounded, because a lost context reports errors without end.
    for (int i = 0; i < 16; ++i) {
        const GLenum error = gl().GetError();
        if (error == GL_NO_ERROR) break;
        if (first == GL_NO_ERROR) first = error;
    }
    const std::string message = state_->messages.take();
    if (first == GL_CONTEXT_LOST || gl().GetGraphicsResetStatus() != GL_NO_ERROR)
        throw GlContextLost("OpenGL", doing + ": the GPU was reset and the context is lost",
                            "start again; if it happens again, use smaller images or another driver");
    if (first == GL_OUT_OF_MEMORY)
        throw InputError("OpenGL", doing + ": out of memory" + (message.empty() ? "" : ": " + message),
                         "use fewer texels, a lower order, smaller tables or a smaller image");
    if (first != GL_NO_ERROR)
        throw Error("OpenGL", doing + ": " + glErrorName(first) + (message.empty() ? "" : ": " + message));
    if (!message.empty()) throw Error("OpenGL", doing + ": " + message);
}

}  // namespace prt
