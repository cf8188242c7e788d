// What GlContext needs of a window-system interface. Internal.
#pragma once

#include <initializer_list>
#include <memory>
#include <string>

#include "runtime/gl_context.h"

namespace prt {

/// One context of one interface.
class GlBackend {
  public:
    virtual ~GlBackend() = default;
    virtual GlContextKind kind() const = 0;
    /// A function by name; may be non-null for names that it does not know.
    virtual GlProc proc(const char* name) const = 0;
    virtual bool isCurrent() const = 0;
    /// @throws Error
    virtual void makeCurrent() const = 0;
    /// Leaves no context current on the thread; nothing where the context is the caller's.
    virtual void release() const = 0;
    virtual void* window() const { return nullptr; }
};

/// @throws InputError  no library, no OpenGL 4.5 core
std::unique_ptr<GlBackend> makeOsMesaBackend();
/// @param debug        asks for a debug context
/// @throws InputError  no library, no usable device, no OpenGL 4.5 core
std::unique_ptr<GlBackend> makeEglBackend(bool debug);
/// @param debug        asks for a debug context
/// @throws InputError  no display, no OpenGL 4.5 core, or a build without PRT_WITH_VIEWER
std::unique_ptr<GlBackend> makeWindowBackend(const GlWindowOptions& options, bool debug);
/// @param getProc      null: that of the interface whose context is current
/// @throws InputError  none is current
std::unique_ptr<GlBackend> makeCallerBackend(GlGetProc getProc);

/// Opens a library for good, with its symbols to itself.
/// @param variable     of the environment; its value, if any, is the only name tried
/// @param names        tried in order
/// @param remedy       of the error
/// @throws InputError  none can be loaded
void* openGlLibrary(const char* variable, std::initializer_list<const char*> names, const char* remedy);
/// @throws InputError  the library lacks it
GlProc glLibrarySymbol(void* library, const char* libraryName, const char* name, const char* remedy);

}  // namespace prt
