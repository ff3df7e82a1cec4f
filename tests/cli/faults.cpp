// For LD_PRELOAD: the function that FAULT names fails as a system without memory, processes or a sound disk would let it. faults.py compiles it.
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <unistd.h>
#include <zlib.h>

namespace {

bool asked_for(const char* name) {
  const char* fault = std::getenv("FAULT");
  return fault && std::strcmp(fault, name) == 0;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

// Whether `fd` reads, and does not write, a file whose path holds FAULT_FILE.
bool reads_the_file(int fd) {
  const char* part = std::getenv("FAULT_FILE");
  char path[4096];
  const ssize_t size = ::readlink(("/proc/self/fd/" + std::to_string(fd)).c_str(), path, sizeof path);
  return part && size > 0 && std::string(path, static_cast<std::size_t>(size)).find(part) != std::string::npos && (::fcntl(fd, F_GETFL) & O_ACCMODE) == O_RDONLY;
}

}  // namespace

extern "C" {

int compress2(Bytef* to, uLongf* to_size, const Bytef* from, uLong from_size, int level) {
  if (asked_for("compress2")) return Z_MEM_ERROR;
  if (asked_for("a thrown surprise")) throw std::logic_error("a surprise");
  return next<int(Bytef*, uLongf*, const Bytef*, uLong, int)>("compress2")(to, to_size, from, from_size, level);
}

int deflateInit2_(z_streamp stream, int level, int method, int bits, int memory, int strategy, const char* version, int size) {
  if (asked_for("deflateInit2")) return Z_MEM_ERROR;
  return next<int(z_streamp, int, int, int, int, int, const char*, int)>("deflateInit2_")(stream, level, method, bits, memory, strategy, version, size);
}

int inflateInit2_(z_streamp stream, int bits, const char* version, int size) {
  if (asked_for("inflateInit2")) return Z_MEM_ERROR;
  return next<int(z_streamp, int, const char*, int)>("inflateInit2_")(stream, bits, version, size);
}

pid_t fork() noexcept {
  if (asked_for("fork")) return errno = EAGAIN, -1;
  return next<pid_t()>("fork")();
}

ssize_t read(int fd, void* to, size_t size) {
  if (asked_for("read") && reads_the_file(fd)) return errno = EIO, -1;
  return next<ssize_t(int, void*, size_t)>("read")(fd, to, size);
}

// Does not fail: a file of 70 GB that is one hole is there to be looked at, and not to be read as a whole.
void* mmap(void* at, size_t size, int protection, int flags, int fd, off_t offset) noexcept {
  if (asked_for("nothing, and maps lazily")) flags &= ~MAP_POPULATE;
  return next<void*(void*, size_t, int, int, int, off_t)>("mmap")(at, size, protection, flags, fd, offset);
}

// Those that TBB asks for: other libraries start some before main.
int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*), void* argument) noexcept {
  Dl_info caller{};
  if (asked_for("pthread_create") && ::dladdr(__builtin_return_address(0), &caller) && caller.dli_fname && std::strstr(caller.dli_fname, "tbb")) return EAGAIN;
  return next<int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)>("pthread_create")(thread, attributes, run, argument);
}

// The first corner of the first triangle becomes a point that is not there.
int lib3mf_meshobject_gettriangleindices(void* mesh, std::uint32_t* corners, std::uint32_t size, std::uint32_t* written) {
  const int state = next<int(void*, std::uint32_t*, std::uint32_t, std::uint32_t*)>("lib3mf_meshobject_gettriangleindices")(mesh, corners, size, written);
  if (asked_for("gettriangleindices") && size > 0) corners[0] = 99;
  return state;
}

}
