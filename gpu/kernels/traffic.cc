// Counts the memory of the device that a kernel reads and writes, by the calls that g++ inserts before each access with
// -fsanitize=thread. This file is compiled without that option; without it in the kernels, nothing is counted.
#include "traffic.h"
#include <cstdint>
#include <map>
#include <vector>

namespace {

// Memory moves in sectors of this many bytes.
constexpr uintptr_t SECTOR = 32;

// A piece of memory, and the sectors that were read and written since the last count.
struct Piece {
    uintptr_t bytes;
    std::vector<bool> touched[2];
};

// By address.
std::map<uintptr_t, Piece> pieces;
uintptr_t touched = 0;
bool is_counting = false;

void touch(uintptr_t address, uintptr_t bytes, int is_write)
{
    if (!is_counting) return;
    auto after = pieces.upper_bound(address);
    if (after == pieces.begin()) return;
    auto &[begin, piece] = *--after;
    if (address + bytes > begin + piece.bytes) return;
    for (uintptr_t at = (address - begin) / SECTOR; at <= (address + bytes - 1 - begin) / SECTOR; at++) {
        if (piece.touched[is_write][at]) continue;
        piece.touched[is_write][at] = true;
        touched++;
    }
}

} // namespace

void traffic::add(void *memory, unsigned long long bytes)
{
    std::vector<bool> none((bytes + SECTOR - 1) / SECTOR);
    pieces[(uintptr_t)memory] = {(uintptr_t)bytes, {none, none}};
}

void traffic::remove(void *memory) { pieces.erase((uintptr_t)memory); }

void traffic::begin()
{
    touched = 0;
    is_counting = true;
}

unsigned long long traffic::end()
{
    is_counting = false;
    if (touched == 0) return 0;
    for (auto &[address, piece] : pieces)
        for (auto &list : piece.touched) list.assign(list.size(), false);
    return SECTOR * touched;
}

#define ACCESS(bytes)                                                                          \
    void __tsan_read##bytes(void *at) { touch((uintptr_t)at, bytes, 0); }                      \
    void __tsan_write##bytes(void *at) { touch((uintptr_t)at, bytes, 1); }                     \
    void __tsan_unaligned_read##bytes(void *at) { touch((uintptr_t)at, bytes, 0); }            \
    void __tsan_unaligned_write##bytes(void *at) { touch((uintptr_t)at, bytes, 1); }

extern "C" {
void __tsan_init() {}
void __tsan_func_entry(void *) {}
void __tsan_func_exit() {}
void __tsan_vptr_update(void *, void *) {}
void __tsan_vptr_read(void *) {}
void __tsan_read_range(void *at, unsigned long bytes) { touch((uintptr_t)at, bytes, 0); }
void __tsan_write_range(void *at, unsigned long bytes) { touch((uintptr_t)at, bytes, 1); }
ACCESS(1)
ACCESS(2)
ACCESS(4)
ACCESS(8)
ACCESS(16)
}
