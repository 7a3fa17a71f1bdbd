// A device without hardware: serves memory, kernels and transforms to gpu/src/emulator.rs by standard input and output.
//   emulator SEED
#include "emulator.h"

#include "task.h"
#include "traffic.h"
typedef void (*Kernel)(const Task &);
static std::map<std::string, Kernel> kernels;

struct Registration {
    Registration(const char *name, Kernel kernel) { kernels[name] = kernel; }
};
#define KERNEL(name, ...)                                         \
    static void name##_kernel(const Task &task) { __VA_ARGS__(task); } \
    static const Registration name##_registration(#name, name##_kernel);
#include "far_field.cu"

typedef unsigned long long Word;

static void read_bytes(void *to, size_t bytes)
{
    if (bytes > 0 && fread(to, 1, bytes, stdin) != bytes) exit(bytes == sizeof(Word) ? 0 : 1);
}

static Word read_word()
{
    Word word;
    read_bytes(&word, sizeof word);
    return word;
}

static void reply(const void *from, size_t bytes)
{
    fwrite(from, 1, bytes, stdout);
    fflush(stdout);
}

static void reply_word(Word word) { reply(&word, sizeof word); }

static void launch()
{
    std::string name(read_word(), ' ');
    read_bytes(&name[0], name.size());
    Word blocks = read_word(), threads = read_word(), bytes = read_word();
    Task task;
    auto kernel = kernels.find(name);
    if (bytes != sizeof task || kernel == kernels.end()) {
        fprintf(stderr, "no kernel %s with %llu bytes of arguments; they are %zu\n", name.c_str(), bytes, sizeof task);
        exit(1);
    }
    read_bytes(&task, bytes);
    traffic::begin();
    emulator::launch((unsigned)blocks, (unsigned)threads, [&] { kernel->second(task); });
    reply_word(traffic::end());
}

struct Line {
    std::vector<double> re, im;
    explicit Line(size_t count) : re(count), im(count) {}
};

// Plain sums along one axis of values on a grid.
static void transform_axis(Line &all, const int points[3], int axis, double sign)
{
    int n = points[axis], stride = axis == 0 ? 1 : axis == 1 ? points[0] : points[0] * points[1];
    int count = points[0] * points[1] * points[2];
    Line line(n), turn(n);
    for (int m = 0; m < n; m++) {
        turn.re[m] = cos(2 * M_PI * m / n);
        turn.im[m] = sign * sin(2 * M_PI * m / n);
    }
    for (int first = 0; first < count; first++) {
        if (first / stride % n != 0) continue;
        for (int m = 0; m < n; m++) {
            line.re[m] = line.im[m] = 0;
            for (int i = 0; i < n; i++) {
                double re = all.re[first + i * stride], im = all.im[first + i * stride];
                double c = turn.re[(long)i * m % n], s = turn.im[(long)i * m % n];
                line.re[m] += re * c - im * s;
                line.im[m] += re * s + im * c;
            }
        }
        for (int m = 0; m < n; m++) all.re[first + m * stride] = line.re[m], all.im[first + m * stride] = line.im[m];
    }
}

// Parts of a transform, as in gpu/src/emulator.rs.
enum Part { WHOLE, PLANES, ALONG_Z };

// Modes of planes to modes, and back.
template <typename T> static void transform_along_z(bool is_forward, const int n[3], T *spectrum)
{
    const int modes[3] = {n[0] / 2 + 1, n[1], n[2]};
    int count = modes[0] * modes[1] * modes[2];
    for (int c = 0; c < 3; c++, spectrum += 2 * count) {
        Line all(count);
        for (int at = 0; at < count; at++) all.re[at] = spectrum[2 * at], all.im[at] = spectrum[2 * at + 1];
        transform_axis(all, modes, 2, is_forward ? -1 : 1);
        for (int at = 0; at < count; at++) spectrum[2 * at] = (T)all.re[at], spectrum[2 * at + 1] = (T)all.im[at];
    }
}

// Three components from values on the grid to the half of their modes with m1 <= nx/2, and back, or to the modes of each
// plane. Neither has a factor.
template <typename T> static void transform(bool is_forward, Part part, const int n[3], T *field, T *spectrum)
{
    if (part == ALONG_Z) return transform_along_z(is_forward, n, spectrum);
    int columns = n[0] / 2 + 1, count = n[0] * n[1] * n[2];
    for (int c = 0; c < 3; c++, field += count, spectrum += 2 * columns * n[1] * n[2]) {
        Line all(count);
        for (int at = 0; at < count; at++) {
            int x = at % n[0], y = at / n[0] % n[1], z = at / (n[0] * n[1]);
            bool is_conjugate = x >= columns;
            if (is_conjugate) x = n[0] - x, y = (n[1] - y) % n[1], z = part == WHOLE ? (n[2] - z) % n[2] : z;
            const T *mode = spectrum + 2 * ((z * n[1] + y) * columns + x);
            all.re[at] = is_forward ? field[at] : mode[0];
            all.im[at] = is_forward ? 0 : is_conjugate ? -mode[1] : mode[1];
        }
        for (int axis = 0; axis < (part == WHOLE ? 3 : 2); axis++) transform_axis(all, n, axis, is_forward ? -1 : 1);
        for (int at = 0; at < count; at++) {
            int x = at % n[0], y = at / n[0] % n[1], z = at / (n[0] * n[1]);
            T *mode = spectrum + 2 * ((z * n[1] + y) * columns + x);
            if (!is_forward) field[at] = (T)all.re[at];
            else if (x < columns) mode[0] = (T)all.re[at], mode[1] = (T)all.im[at];
        }
    }
}

static void transform()
{
    bool is_forward = read_word(), is_single = read_word();
    Part part = (Part)read_word();
    int points[3];
    for (int axis = 0; axis < 3; axis++) points[axis] = (int)read_word();
    void *field = (void *)read_word(), *spectrum = (void *)read_word();
    if (is_single) transform(is_forward, part, points, (float *)field, (float *)spectrum);
    else transform(is_forward, part, points, (double *)field, (double *)spectrum);
    reply_word(0);
}

// Commands, as in gpu/src/emulator.rs.
enum Command { ALLOCATE, FREE, ZERO, UPLOAD, DOWNLOAD, LAUNCH, TRANSFORM };

int main(int, char **arguments)
{
    emulator::shuffler.seed(strtoull(arguments[1], nullptr, 10));
    for (;;) {
        Word command = read_word();
        if (command == LAUNCH) {
            launch();
            continue;
        }
        if (command == TRANSFORM) {
            transform();
            continue;
        }
        Word first = read_word();
        if (command == ALLOCATE) {
            void *memory = nullptr;
            // Aligned as that of a card.
            if (posix_memalign(&memory, 256, first) != 0) exit(1);
            memset(memory, emulator::UNSET, first);
            traffic::add(memory, first);
            reply_word((Word)memory);
        } else if (command == FREE) {
            traffic::remove((void *)first);
            free((void *)first);
        } else {
            Word bytes = read_word();
            if (command == ZERO) memset((void *)first, 0, bytes);
            else if (command == UPLOAD) read_bytes((void *)first, bytes);
            else if (command == DOWNLOAD) reply((void *)first, bytes);
        }
    }
}
