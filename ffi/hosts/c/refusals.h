/* What the programs share that show how bad input is refused. */
#ifndef REFUSALS_H
#define REFUSALS_H

#include <math.h>
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int refusals = 0;
static palp_world *world;

static uint64_t hash_of(const palp_world *of) {
    uint64_t hash = 0;
    if (palp_state_hash(of, &hash) != PALP_OK) {
        printf("palp_state_hash is refused\n");
        exit(1);
    }
    return hash;
}

static void expect(palp_status got, palp_status wanted, const char *call, int line) {
    if (got != wanted) {
        printf("line %d: %s gave %d (%s) instead of %d (%s)\n", line, call, (int)got,
               palp_status_text(got), (int)wanted, palp_status_text(wanted));
        exit(1);
    }
    refusals += wanted < 0;
}

/* A refused call leaves no trace in the world. */
#define REFUSED(wanted, call)                                                                      \
    do {                                                                                           \
        const uint64_t before = hash_of(world);                                                    \
        expect(call, wanted, #call, __LINE__);                                                     \
        if (hash_of(world) != before) {                                                            \
            printf("line %d: %s changed the world\n", __LINE__, #call);                            \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

#define FINE(call) expect(call, PALP_OK, #call, __LINE__)
#define GIVES(wanted, call) expect(call, wanted, #call, __LINE__)
#define TRUE(condition) expect((condition) ? PALP_OK : PALP_PANICKED, PALP_OK, #condition, __LINE__)

static const palp_body_id null_body = {0, 0};
static char *memory;
static size_t memory_bytes;

/* An address that no type of the header may have. */
#define CROOKED(type, buffer) ((type)(void *)((char *)(buffer) + 1))

static void *aligned(void *start) {
    const size_t past = (size_t)start % PALP_BLOCK_ALIGNMENT;
    return (char *)start + (past == 0 ? 0 : PALP_BLOCK_ALIGNMENT - past);
}

#endif
