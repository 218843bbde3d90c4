// Kills the process at its KILL_AT-th change of a file system, or lets that one change fail, for
// tests of what a run leaves behind. It is linked in front of the C library with LD_PRELOAD. Half
// of the bytes of a write at which it kills reach the file. With FAIL_ERRNO the change fails with
// this error instead, and all later ones succeed; with FAIL_ERRNO=0 a write is short, and anything
// else succeeds. Every change is written to KILL_TRACE.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static long changes;

static long at(const char *name) {
    const char *text = getenv(name);
    return text ? atol(text) : 0;
}

static const char *path_of(int fd) {
    static __thread char path[4096];
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t length = readlink(link, path, sizeof path - 1);
    path[length < 0 ? 0 : length] = 0;
    return path;
}

// Whether this is the change at which to kill. Writes the change to the trace in any case.
static int is_due(const char *what, const char *path) {
    static int (*open_)(const char *, int, ...);
    static ssize_t (*write_)(int, const void *, size_t);
    if (!open_) open_ = dlsym(RTLD_NEXT, "open");
    if (!write_) write_ = dlsym(RTLD_NEXT, "write");
    long number = __atomic_add_fetch(&changes, 1, __ATOMIC_SEQ_CST);
    const char *trace = getenv("KILL_TRACE");
    if (trace) {
        char line[4200];
        int length = snprintf(line, sizeof line, "%ld %s %s\n", number, what, path);
        int fd = open_(trace, O_WRONLY | O_CREAT | O_APPEND, 0600);
        if (write_(fd, line, length)) {}
        close(fd);
    }
    return number == at("KILL_AT");
}

// What happens at the change that is due: a kill, an error (-1), or a short write (0).
static int fault(void) {
    const char *code = getenv("FAIL_ERRNO");
    if (!code) kill(getpid(), SIGKILL);
    errno = atoi(code);
    return errno ? -1 : 0;
}

static int is_file(int fd) {
    struct stat there;
    return fstat(fd, &there) == 0 && S_ISREG(there.st_mode);
}

#define NEXT(name) \
    static __typeof__(name) *next; \
    if (!next) next = dlsym(RTLD_NEXT, #name)

ssize_t write(int fd, const void *bytes, size_t n) {
    NEXT(write);
    if (is_file(fd) && is_due("write", path_of(fd))) {
        if (!getenv("FAIL_ERRNO") && next(fd, bytes, n / 2)) {}
        return fault() ? -1 : next(fd, bytes, (n + 1) / 2);
    }
    return next(fd, bytes, n);
}

ssize_t pwrite64(int fd, const void *bytes, size_t n, off64_t offset) {
    NEXT(pwrite64);
    if (is_file(fd) && is_due("write", path_of(fd))) {
        if (!getenv("FAIL_ERRNO") && next(fd, bytes, n / 2, offset)) {}
        return fault() ? -1 : next(fd, bytes, (n + 1) / 2, offset);
    }
    return next(fd, bytes, n, offset);
}

ssize_t pwrite(int fd, const void *bytes, size_t n, off_t offset) { return pwrite64(fd, bytes, n, offset); }

#define ON_FD(name) \
    int name(int fd) { \
        NEXT(name); \
        if (is_due("sync", path_of(fd)) && fault()) return -1; \
        return next(fd); \
    }
ON_FD(fsync)
ON_FD(fdatasync)

int ftruncate64(int fd, off64_t length) {
    NEXT(ftruncate64);
    if (is_due("truncate", path_of(fd)) && fault()) return -1;
    return next(fd, length);
}

int rename(const char *from, const char *to) {
    NEXT(rename);
    if (is_due("rename", to) && fault()) return -1;
    return next(from, to);
}

int linkat(int a, const char *from, int b, const char *to, int flags) {
    NEXT(linkat);
    if (is_due("link", to) && fault()) return -1;
    return next(a, from, b, to, flags);
}

int link(const char *from, const char *to) {
    NEXT(link);
    if (is_due("link", to) && fault()) return -1;
    return next(from, to);
}

#define ON_PATH(name, what) \
    int name(const char *path) { \
        NEXT(name); \
        if (is_due(what, path) && fault()) return -1; \
        return next(path); \
    }
ON_PATH(unlink, "unlink")
ON_PATH(rmdir, "rmdir")

int mkdir(const char *path, mode_t mode) {
    NEXT(mkdir);
    if (is_due("mkdir", path) && fault()) return -1;
    return next(path, mode);
}

// A file that is opened to be created.
static mode_t mode_of(int flags, va_list arguments) { return flags & O_CREAT ? va_arg(arguments, mode_t) : 0; }

#define ON_OPEN(name) \
    int name(const char *path, int flags, ...) { \
        NEXT(name); \
        va_list arguments; \
        va_start(arguments, flags); \
        mode_t mode = mode_of(flags, arguments); \
        va_end(arguments); \
        if (flags & O_CREAT && getenv("FAIL_ERRNO") && is_due("open", path) && fault()) return -1; \
        return next(path, flags, mode); \
    }
ON_OPEN(open)
ON_OPEN(open64)
