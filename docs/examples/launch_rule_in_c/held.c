/* A launch rule as it would stand in a firmware: the force along x has been above a level for a time.
 *
 * A sample stands for the time since the last one. After a gap, or a stamp that does not follow, the hold begins anew.
 * A force that is NaN or beyond all physics is not above. No memory is allocated.
 *
 *     cc -O2 -ffp-contract=off -shared -fPIC -o libheld.so held.c
 */
#include <stdbool.h>

typedef struct {
    double level, hold, longest; /* m/s^2, s, s */
    double last, since;          /* s */
    bool begun, above, done;
} held_t;

void held_reset(held_t *h) { h->begun = h->above = h->done = false; }

void held_init(held_t *h, double rate, double level, double hold) {
    h->level = level;
    h->hold = hold;
    h->longest = 3.5 / rate;
    held_reset(h);
}

bool held_step(held_t *h, double t, double fx) {
    double dt = t - h->last;
    if (!h->begun || !(dt > 0.0 && dt <= h->longest)) h->above = false;
    h->begun = true;
    h->last = t;
    if (!(fx > h->level && fx < 4000.0)) {
        h->above = false;
        return false;
    }
    if (!h->above) {
        h->above = true;
        h->since = t;
    }
    if (h->done || t - h->since < h->hold) return false;
    h->done = true;
    return true;
}
