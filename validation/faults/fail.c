/* Makes a chosen call on a file fail, to see what a program makes of it. To be loaded before the C library (LD_PRELOAD).

   FAULT_FOLDER  only files below this folder count, given as an absolute path
   FAULT_RANK    only this rank of an MPI job counts, 0 by default
   FAULT_LOG     a file that gets a line `call process path` for each call that counts, or for the one that fails; and in a
                 list of calls a line `long process path` after a write that goes over the end of a page of memory
   FAULT_CALL    which call: open, write, sync, rename, unlink, truncate, mkdir or close
   FAULT_AT      the n-th such call of each process fails; 0, the default, lets all pass and lists them in the log
   FAULT_ERROR   the number of the error (errno)
   FAULT_HOW     `once`; `stays`: and so does whatever needs room from then on; `short`: the write ends at a
                 page of memory and the next one fails; `always`: every such call fails; `killed`: the program is killed
                 before the call; `torn`: it is killed when the write is at the last page of memory that it comes to */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))real(#name))

static const char *folder, *call;
static long at;
static int error_number, stays, is_short, always, kills, log_file = -1;
static atomic_long count;
static atomic_int full, cut;

static void *real(const char *name) { return dlsym(RTLD_NEXT, name); }

static const char *word(const char *name, const char *otherwise) {
    const char *value = getenv(name);
    return value ? value : otherwise;
}

__attribute__((constructor)) static void start(void) {
    const char *how = word("FAULT_HOW", "once"), *path = getenv("FAULT_LOG");
    if (strcmp(word("OMPI_COMM_WORLD_RANK", "0"), word("FAULT_RANK", "0")) != 0) return;
    folder = getenv("FAULT_FOLDER");
    call = word("FAULT_CALL", "");
    at = atol(word("FAULT_AT", "0"));
    error_number = atoi(word("FAULT_ERROR", "5"));
    stays = strcmp(how, "stays") == 0;
    is_short = strcmp(how, "short") == 0 || strcmp(how, "torn") == 0;
    kills = strcmp(how, "killed") == 0 || strcmp(how, "torn") == 0;
    always = strcmp(how, "always") == 0;
    if (path) log_file = (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
}

static void note(const char *name, const char *path) {
    char line[PATH_MAX + 32];
    int length = snprintf(line, sizeof line, "%s %d %s\n", name, (int)getpid(), path);
    if (log_file >= 0 && length > 0) syscall(SYS_write, log_file, line, (size_t)length);
}

static int is_below(const char *path) {
    size_t length = folder ? strlen(folder) : 0;
    return length && strncmp(path, folder, length) == 0 && (path[length] == '/' || path[length] == 0);
}

/* Whether a call on a path fails now; `needs_room` as on a full disk. */
static int fails(const char *name, const char *path, int needs_room) {
    if (!is_below(path)) return 0;
    if (full && needs_room) return 1;
    if (always) return strcmp(name, call) == 0;
    if (at == 0) note(name, path);
    if (at == 0 || strcmp(name, call) != 0) return 0;
    if (cut) { cut = 0; return 1; }
    if (atomic_fetch_add(&count, 1) + 1 != at) return 0;
    note(name, path);
    full = stays;
    if (kills && !is_short) kill(getpid(), SIGKILL);
    return 1;
}

static const char *path_of(int descriptor, char *path) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    ssize_t length = readlink(link, path, PATH_MAX - 1);
    path[length < 0 ? 0 : length] = 0;
    return path;
}

static const char *path_at(int directory, const char *name, char *path) {
    char parent[PATH_MAX];
    if (name[0] == '/') return name;
    if (directory == AT_FDCWD) {
        if (!getcwd(parent, sizeof parent)) return name;
    } else {
        path_of(directory, parent);
    }
    snprintf(path, PATH_MAX, "%.*s/%s", PATH_MAX / 2, parent, name);
    return path;
}

#define FAIL_IF(condition) if (condition) { if (kills) kill(getpid(), SIGKILL); errno = error_number; return -1; }

/* After the first part of a write. */
static ssize_t parted(ssize_t written) {
    if (kills) kill(getpid(), SIGKILL);
    return written;
}

/* How much of a write goes into the file whose next write fails: what is before the last page boundary in it, as when
   the system finds no room for another page. 0 where there is none. */
static size_t part(int descriptor, size_t size, off_t place, int *failed) {
    const off_t page = 4096;
    char path[PATH_MAX];
    int is_second = cut;
    *failed = fails("write", path_of(descriptor, path), 1);
    off_t boundary = (place + (off_t)size - 1) / page * page;
    if (at == 0 && boundary > place && is_below(path)) note("long", path);
    if (!*failed || !is_short || is_second || boundary <= place) return 0;
    cut = 1;
    return (size_t)(boundary - place);
}

static off_t place_of(int descriptor) {
    struct stat file;
    if (fcntl(descriptor, F_GETFL) & O_APPEND && fstat(descriptor, &file) == 0) return file.st_size;
    return lseek(descriptor, 0, SEEK_CUR);
}

ssize_t write(int descriptor, const void *bytes, size_t size) {
    int failed;
    size_t first = part(descriptor, size, place_of(descriptor), &failed);
    if (first) return parted(REAL(write)(descriptor, bytes, first));
    FAIL_IF(failed)
    return REAL(write)(descriptor, bytes, size);
}

static ssize_t write_at(int descriptor, const void *bytes, size_t size, off_t place) {
    int failed;
    size_t first = part(descriptor, size, place, &failed);
    if (first) return parted(REAL(pwrite)(descriptor, bytes, first, place));
    FAIL_IF(failed)
    return REAL(pwrite)(descriptor, bytes, size, place);
}

ssize_t pwrite(int d, const void *bytes, size_t size, off_t place) { return write_at(d, bytes, size, place); }
ssize_t pwrite64(int d, const void *bytes, size_t size, off64_t place) { return write_at(d, bytes, size, place); }

ssize_t writev(int descriptor, const struct iovec *parts, int number) {
    char path[PATH_MAX];
    FAIL_IF(fails("write", path_of(descriptor, path), 1))
    return REAL(writev)(descriptor, parts, number);
}

ssize_t copy_file_range(int from, off64_t *a, int to, off64_t *b, size_t size, unsigned flags) {
    char path[PATH_MAX];
    FAIL_IF(fails("write", path_of(to, path), 1))
    return REAL(copy_file_range)(from, a, to, b, size, flags);
}

static int open_at(int directory, const char *name, int flags, mode_t mode) {
    char path[PATH_MAX];
    FAIL_IF(fails("open", path_at(directory, name, path), flags & O_CREAT))
    return REAL(openat)(directory, name, flags, mode);
}

static mode_t mode_of(int flags, va_list rest) { return flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0; }

#define OPEN(name)                                                                                                     \
    int name(const char *path, int flags, ...) {                                                                       \
        va_list rest;                                                                                                  \
        va_start(rest, flags);                                                                                         \
        mode_t mode = mode_of(flags, rest);                                                                            \
        va_end(rest);                                                                                                  \
        return open_at(AT_FDCWD, path, flags, mode);                                                                   \
    }
OPEN(open)
OPEN(open64)

#define OPENAT(name)                                                                                                   \
    int name(int directory, const char *path, int flags, ...) {                                                        \
        va_list rest;                                                                                                  \
        va_start(rest, flags);                                                                                         \
        mode_t mode = mode_of(flags, rest);                                                                            \
        va_end(rest);                                                                                                  \
        return open_at(directory, path, flags, mode);                                                                  \
    }
OPENAT(openat64)

int fsync(int descriptor) {
    char path[PATH_MAX];
    FAIL_IF(fails("sync", path_of(descriptor, path), 1))
    return REAL(fsync)(descriptor);
}

int fdatasync(int descriptor) {
    char path[PATH_MAX];
    FAIL_IF(fails("sync", path_of(descriptor, path), 1))
    return REAL(fdatasync)(descriptor);
}

int rename(const char *from, const char *to) {
    char path[PATH_MAX];
    FAIL_IF(fails("rename", path_at(AT_FDCWD, to, path), 1))
    return REAL(rename)(from, to);
}

int unlink(const char *name) {
    char path[PATH_MAX];
    FAIL_IF(fails("unlink", path_at(AT_FDCWD, name, path), 0))
    return REAL(unlink)(name);
}

int unlinkat(int directory, const char *name, int flags) {
    char path[PATH_MAX];
    FAIL_IF(fails("unlink", path_at(directory, name, path), 0))
    return REAL(unlinkat)(directory, name, flags);
}

static int truncate_to(int descriptor, off_t size) {
    char path[PATH_MAX];
    FAIL_IF(fails("truncate", path_of(descriptor, path), 0))
    return REAL(ftruncate)(descriptor, size);
}

int ftruncate(int descriptor, off_t size) { return truncate_to(descriptor, size); }
int ftruncate64(int descriptor, off64_t size) { return truncate_to(descriptor, size); }

int mkdir(const char *name, mode_t mode) {
    char path[PATH_MAX];
    FAIL_IF(fails("mkdir", path_at(AT_FDCWD, name, path), 1))
    return REAL(mkdir)(name, mode);
}

/* The file is closed all the same, as by the system. */
int close(int descriptor) {
    char path[PATH_MAX];
    int failed = fails("close", path_of(descriptor, path), 0), closed = REAL(close)(descriptor);
    FAIL_IF(failed)
    return closed;
}
