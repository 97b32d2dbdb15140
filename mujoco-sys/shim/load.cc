// Guards of the XML loader and saver, which are C++ inside: they throw (std::bad_alloc at least),
// hold a lock while parsing, switch the thread's locale, and install an error handler that they do
// not remove when they throw. These guards catch the exceptions and restore the locale and the
// handlers. An engine error that reaches the guard's handler skips the release of the parser's
// lock, so after MUJOCO_SYS_ERROR the next load would deadlock: the caller must not make it.
#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif

#include <clocale>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#if defined(__APPLE__)
#include <xlocale.h>
#endif

#include "exception.h"
#include "guard.h"
#include "optional.h"

namespace {

// Finds a private function of the engine, which newer engines lack, in the library of its public
// functions: the process can contain a second engine. A weak symbol would do for ELF only: the
// linkers for other formats reject symbols that no library defines.
template <typename Function>
Function* find(const char* name) {
#if defined(_WIN32)
  return reinterpret_cast<Function*>(reinterpret_cast<void*>(GetProcAddress(GetModuleHandleA("mujoco.dll"), name)));
#else
  Dl_info engine;
  void* library = nullptr;
  if (dladdr(reinterpret_cast<void*>(&mj_version), &engine)) library = dlopen(engine.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
  // The address can be that of a jump in a program that is not position-independent.
  return reinterpret_cast<Function*>(dlsym(library ? library : RTLD_DEFAULT, name));
#endif
}

typedef void mujoco_sys_handler(const char*);
const auto get_error_handler = find<mujoco_sys_handler*()>("_mjPRIVATE__get_tls_error_fn");
const auto set_error_handler = find<void(mujoco_sys_handler*)>("_mjPRIVATE__set_tls_error_fn");
const auto get_warning_handler = find<mujoco_sys_handler*()>("_mjPRIVATE__get_tls_warning_fn");
const auto set_warning_handler = find<void(mujoco_sys_handler*)>("_mjPRIVATE__set_tls_warning_fn");
// Significant digits of numbers in written XML, per thread. The default is 6.
const auto get_xml_precision = find<int()>("_mjPRIVATE__get_xml_precision");
const auto set_xml_precision = find<void(int)>("_mjPRIVATE__set_xml_precision");

// Thread-local state that the loader may leave changed. On Windows the locale is not part of it:
// the engine changes that of its C library, which Rust does not use.
struct ThreadState {
#if !defined(_WIN32)
  locale_t locale = uselocale(static_cast<locale_t>(0));
#endif
  mujoco_sys_guard* guard = *mujoco_sys_innermost();
  mujoco_sys_catcher* call = *mujoco_sys_innermost_call();
  mujoco_sys_handler* error = get_error_handler ? get_error_handler() : nullptr;
  mujoco_sys_handler* warning = get_warning_handler ? get_warning_handler() : nullptr;

  void restore() const {
#if !defined(_WIN32)
    uselocale(locale);
#endif
    *mujoco_sys_innermost() = guard;
    *mujoco_sys_innermost_call() = call;
    if (set_error_handler) set_error_handler(error);
    if (set_warning_handler) set_warning_handler(warning);
  }
};

// Sets the message for an exception of another library than this file's, and returns the code.
inline int caught(const char* type) {
  if (std::strcmp(type, "St9bad_alloc") == 0 || std::strcmp(type, ".?AVbad_alloc@std@@") == 0) {
    mujoco_sys_set_message("out of memory");
    return MUJOCO_SYS_OUT_OF_MEMORY;
  }
  char message[200];
  std::snprintf(message, sizeof(message), "an exception of type %s", type);
  mujoco_sys_set_message(message);
  return MUJOCO_SYS_EXCEPTION;
}

// Calls a function, and returns the code of an exception that leaves it.
template <typename Call>
int catching(Call& call) {
  // The function has no object with a destructor, so that its frame needs no personality routine.
  const auto invoke = [](void* argument) { (*static_cast<Call*>(argument))(); };
#if !defined(__cpp_exceptions)
  const char* type = mujoco_sys_call(invoke, &call);
  return type ? caught(type) : MUJOCO_SYS_OK;
#else
  try {
    const char* type = mujoco_sys_call(invoke, &call);
    return type ? caught(type) : MUJOCO_SYS_OK;
  } catch (const std::bad_alloc&) {
    mujoco_sys_set_message("out of memory");
    return MUJOCO_SYS_OUT_OF_MEMORY;
  } catch (const std::exception& exception) {
    mujoco_sys_set_message(exception.what());
    return MUJOCO_SYS_EXCEPTION;
  } catch (...) {
    mujoco_sys_set_message("an exception of unknown type");
    return MUJOCO_SYS_EXCEPTION;
  }
#endif
}

// Runs `call` behind a guard. The frames of this file that the jump skips hold no object with a
// destructor.
template <typename Call>
int run(Call call) {
  const ThreadState before;
  mujoco_sys_guard guard;
  guard.outer = before.guard;
  if (MUJOCO_SYS_SET_MARK(guard.return_to)) {
    before.restore();
    mujoco_sys_after_error();
    return MUJOCO_SYS_ERROR;
  }
  *mujoco_sys_innermost() = &guard;
  const int status = catching(call);
  before.restore();
  if (status != MUJOCO_SYS_OK) mujoco_sys_after_error();
  return status;
}

}  // namespace

extern "C" {

#if mjVERSION_HEADER >= 300
// Model that was loaded last, which has the sizes of the engine's tree. Its pointers are not used,
// as they may dangle. The caller of this file's functions holds a lock.
static mjModel mujoco_sys_last_loaded;
#endif

int mujoco_sys_mj_loadXML(const char* filename, const mjVFS* vfs, char* error, int error_size, mjModel** result) {
  return run([=] {
    *result = mj_loadXML(filename, vfs, error, error_size);
    // The compiler catches the errors of its trial step.
    if (!*result) mujoco_sys_after_error();
#if mjVERSION_HEADER >= 300
    if (*result) mujoco_sys_last_loaded = **result;
#endif
  });
}

// Since 2.3.1. Raises an error if the library cannot be opened, and if it registers a plugin whose
// name is in use.
int mujoco_sys_mj_loadPluginLibrary(const char* path) {
#if mjVERSION_HEADER >= 325
  return run([=] { mj_loadPluginLibrary(path); });
#elif mjVERSION_HEADER >= 231
  // These engines ignore a failure to open the library, so it is opened here first.
  return run([=] {
#if defined(_WIN32)
    if (!LoadLibraryA(path)) mju_error_s("Error loading plugin library: %s", path);
#else
    if (!dlopen(path, RTLD_NOW | RTLD_LOCAL)) mju_error_s("Error loading plugin library: %s", dlerror());
#endif
    mj_loadPluginLibrary(path);
  });
#else
  (void)path;
  return MUJOCO_SYS_OK;
#endif
}

int mujoco_sys_xml_digits(void) {
  return get_xml_precision && set_xml_precision ? 17 : 6;
}

// Prints all digits of a double if the engine's precision is adjustable.
int mujoco_sys_mj_saveLastXML(const char* filename, const mjModel* m, char* error, int error_size, int* result) {
  const bool adjustable = get_xml_precision && set_xml_precision;
  const int before = adjustable ? get_xml_precision() : 0;
  if (adjustable) set_xml_precision(mujoco_sys_xml_digits());
#if mjVERSION_HEADER >= 300
  // The engine compares these sizes with those of its tree, and does not read the arrays of these
  // lengths. They may differ if the tree is that of the same model, loaded from another directory
  // or after an edit of an inertia.
  mjModel model = *m;
  model.npaths = mujoco_sys_last_loaded.npaths;
#if mjVERSION_HEADER >= 325
  model.nC = mujoco_sys_last_loaded.nC;
#endif
  m = &model;
#endif
  const int status = run([=] { *result = mj_saveLastXML(filename, m, error, error_size); });
  if (adjustable) set_xml_precision(before);
  return status;
}

// Decodes a texture that the model has by reference, since 3.17. The caller frees the pixels with
// mju_free.
int mujoco_sys_mj_loadTexture(const mjModel* m, int texture, mjtByte** data, int size[2], int* colorspace, char* error, int error_size,
                              int* result) {
#if mjVERSION_HEADER >= 3017000
  return run([=] { *result = mj_loadTexture(m, texture, data, size, size + 1, colorspace, error, error_size); });
#else
  (void)m, (void)texture, (void)data, (void)size, (void)colorspace, (void)error, (void)error_size;
  *result = -1;
  return MUJOCO_SYS_OK;
#endif
}

int mujoco_sys_mj_printSchema(const char* filename, char* buffer, int buffer_size, int html, int pad, int* result) {
  return run([=] { *result = mj_printSchema(filename, buffer, buffer_size, html, pad); });
}

}
