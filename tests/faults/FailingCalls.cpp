// Preloaded into a program of ours (LD_PRELOAD): counts its calls of one kind, from main() on and
// in all its processes, and lets one of them fail, or all from that one on. Environment:
//   FAILING_CALLS   write, sync, rename, open or memory
//   FAILING_AT      number of the call that fails, 1 is the first; 0: none
//   FAILING_MODE    once (default) or on: all from that one on
//   FAILING_REPORT  file to which each process appends its number of calls as it ends
//   FAILING_PLACES  file to which each process appends the number of the first call from each
//   place:
//                   each sequence of the six innermost callers
// Standard error is not counted. Other programs that are started (ffmpeg, gnuplot) are left alone.
// A process that is forked goes on counting where its parent was.
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
int __libc_start_main(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(),
                      void*);
}

namespace {

enum class Kind { kNone, kWrite, kSync, kRename, kOpen, kMemory };

Kind failing_kind = Kind::kNone;
long failing_at = 0;
bool failing_on = false;
std::atomic<long> calls{0};
int (*real_main)(int, char**, char**) = nullptr;

constexpr int kCallers = 6, kOwnFrames = 3;
constexpr std::size_t kMostPlaces = 1 << 16;
struct Place {
  std::uint64_t hash = 0;  ///< 0: none
  long first = 0;          ///< number of the first call
};
Place places[kMostPlaces];
bool places_wanted = false;
std::atomic_flag places_taken = ATOMIC_FLAG_INIT;
/// No memory is asked for to reach it, and the search for callers may ask for some.
__attribute__((tls_model("initial-exec"))) thread_local bool in_place = false;

__attribute__((noinline)) void remember(long number) {
  if (!places_wanted || in_place) return;
  in_place = true;
  void* callers[kCallers + kOwnFrames];
  const int count = ::backtrace(callers, kCallers + kOwnFrames);
  std::uint64_t hash = 1469598103934665603ULL;  // FNV-1a, by words
  for (int i = kOwnFrames; i < count; ++i)
    hash = (hash ^ reinterpret_cast<std::uintptr_t>(callers[i])) * 1099511628211ULL;
  while (places_taken.test_and_set()) {
  }
  std::size_t at = hash % kMostPlaces;
  for (std::size_t tries = 0; tries < kMostPlaces; ++tries, at = (at + 1) % kMostPlaces) {
    if (places[at].hash == hash) break;
    if (places[at].hash != 0) continue;
    places[at] = {hash, number};
    break;
  }
  places_taken.clear();
  in_place = false;
}

/// True if this call is to fail.
__attribute__((noinline)) bool fails(Kind kind) {
  if (kind != failing_kind) return false;
  const long number = ++calls;
  remember(number);
  return failing_at > 0 && (number == failing_at || (failing_on && number > failing_at));
}

template <class Function>
Function next(Function, const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

/// A number and a line end, by calls that are not counted.
void append(int file, long value) {
  char text[32];
  int at = sizeof text;
  text[--at] = '\n';
  do text[--at] = static_cast<char>('0' + value % 10);
  while ((value /= 10) > 0);
  ::syscall(SYS_write, file, text + at, sizeof text - static_cast<unsigned>(at));
}

int appended(const char* path) {
  if (path == nullptr) return -1;
  return static_cast<int>(
      ::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND, 0666));
}

void report() {
  if (failing_kind == Kind::kNone) return;
  const long value = calls;
  int file = appended(std::getenv("FAILING_REPORT"));
  if (file >= 0) {
    append(file, value);
    ::syscall(SYS_close, file);
  }
  file = appended(std::getenv("FAILING_PLACES"));
  if (file < 0) return;
  for (const Place& place : places)
    if (place.hash != 0) append(file, place.first);
  ::syscall(SYS_close, file);
}

Kind kindOf(const char* name) {
  const char* const names[] = {"write", "sync", "rename", "open", "memory"};
  for (int i = 0; name != nullptr && i < 5; ++i)
    if (std::strcmp(name, names[i]) == 0) return static_cast<Kind>(i + 1);
  return Kind::kNone;
}

int mainThatFails(int argc, char** argv, char** environment) {
  const char* const at = std::getenv("FAILING_AT");
  const char* const mode = std::getenv("FAILING_MODE");
  failing_at = at != nullptr ? std::atol(at) : 0;
  failing_on = mode != nullptr && std::strcmp(mode, "on") == 0;
  // Of destructors of libraries no program can answer for its memory: they are not counted.
  std::atexit(&report);
  const Kind kind = kindOf(std::getenv("FAILING_CALLS"));
  ::unsetenv("LD_PRELOAD");  // not of what it starts
  places_wanted = std::getenv("FAILING_PLACES") != nullptr;
  void* first[1];
  if (places_wanted) ::backtrace(first, 1);  // loads the unwinder
  failing_kind = kind;
  const int code = real_main(argc, argv, environment);
  report();
  failing_kind = Kind::kNone;
  return code;
}

bool isWriting(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT) != 0; }

int fail(int reason) {
  errno = reason;
  return -1;
}

void* noMemory() {
  errno = ENOMEM;
  return nullptr;
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(),
                      void (*fini)(), void (*rtld_fini)(), void* stack_end) {
  real_main = main;
  return next(&__libc_start_main, "__libc_start_main")(&mainThatFails, argc, argv, init, fini,
                                                       rtld_fini, stack_end);
}

void* malloc(size_t size) { return fails(Kind::kMemory) ? noMemory() : __libc_malloc(size); }
void* calloc(size_t count, size_t size) {
  return fails(Kind::kMemory) ? noMemory() : __libc_calloc(count, size);
}
void* realloc(void* old, size_t size) {
  return fails(Kind::kMemory) ? noMemory() : __libc_realloc(old, size);
}
void* memalign(size_t to, size_t size) {
  return fails(Kind::kMemory) ? noMemory() : __libc_memalign(to, size);
}
void* aligned_alloc(size_t to, size_t size) { return memalign(to, size); }
int posix_memalign(void** out, size_t to, size_t size) {
  void* const memory = memalign(to, size);
  if (memory == nullptr) return ENOMEM;
  *out = memory;
  return 0;
}

ssize_t write(int file, const void* bytes, size_t size) {
  static const auto real = next(&write, "write");
  return file != STDERR_FILENO && fails(Kind::kWrite) ? fail(ENOSPC) : real(file, bytes, size);
}
ssize_t writev(int file, const iovec* parts, int count) {
  static const auto real = next(&writev, "writev");
  return fails(Kind::kWrite) ? fail(ENOSPC) : real(file, parts, count);
}
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  static const auto real = next(&fwrite, "fwrite");
  if (file != stderr && fails(Kind::kWrite)) return errno = ENOSPC, 0;
  return real(bytes, size, count, file);
}
int fputs(const char* text, FILE* file) {
  static const auto real = next(&fputs, "fputs");
  return file != stderr && fails(Kind::kWrite) ? fail(ENOSPC) : real(text, file);
}
int fflush(FILE* file) {
  static const auto real = next(&fflush, "fflush");
  return file != stderr && fails(Kind::kWrite) ? fail(ENOSPC) : real(file);
}
int fclose(FILE* file) {
  static const auto real = next(&fclose, "fclose");
  const bool bad = fails(Kind::kWrite);
  const int result = real(file);
  return bad ? fail(EIO) : result;
}

int fsync(int file) {
  static const auto real = next(&fsync, "fsync");
  return fails(Kind::kSync) ? fail(EIO) : real(file);
}
int fdatasync(int file) {
  static const auto real = next(&fdatasync, "fdatasync");
  return fails(Kind::kSync) ? fail(EIO) : real(file);
}

int rename(const char* from, const char* to) {
  static const auto real = next(&rename, "rename");
  return fails(Kind::kRename) ? fail(EIO) : real(from, to);
}
int renameat(int a, const char* from, int b, const char* to) {
  static const auto real = next(&renameat, "renameat");
  return fails(Kind::kRename) ? fail(EIO) : real(a, from, b, to);
}
int link(const char* from, const char* to) {
  static const auto real = next(&link, "link");
  return fails(Kind::kRename) ? fail(EIO) : real(from, to);
}

int open(const char* path, int flags, ...) {
  static const auto real = next(&open, "open");
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  va_end(rest);
  return isWriting(flags) && fails(Kind::kOpen) ? fail(EMFILE) : real(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  static const auto real = next(&open64, "open64");
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  va_end(rest);
  return isWriting(flags) && fails(Kind::kOpen) ? fail(EMFILE) : real(path, flags, mode);
}
FILE* fopen(const char* path, const char* mode) {
  static const auto real = next(&fopen, "fopen");
  if (mode[0] != 'r' && fails(Kind::kOpen)) return errno = EMFILE, nullptr;
  return real(path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  static const auto real = next(&fopen64, "fopen64");
  if (mode[0] != 'r' && fails(Kind::kOpen)) return errno = EMFILE, nullptr;
  return real(path, mode);
}
int mkdir(const char* path, mode_t mode) {
  static const auto real = next(&mkdir, "mkdir");
  return fails(Kind::kOpen) ? fail(EACCES) : real(path, mode);
}

}  // extern "C"
