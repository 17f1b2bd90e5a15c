/* Every constant of frm_bake.h, pinned. A line here may be added, never changed. */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "frm_bake.h"

/* clang-format off */
#define VALUE(name, expected) {#name, (int64_t)(name), expected},

static const struct row {
    const char *name;
    int64_t value, expected;
} rows[] = {
    VALUE(FRM_BAKE_DRAFT, 0)
    VALUE(FRM_BAKE_STANDARD, 1)
    VALUE(FRM_BAKE_HIGH, 2)
    VALUE(FRM_BAKE_NEW, 0)
    VALUE(FRM_BAKE_PLANNED, 1)
    VALUE(FRM_BAKE_RUNNING, 2)
    VALUE(FRM_BAKE_DONE, 3)
    VALUE(FRM_BAKE_FAILED, 4)
    VALUE(FRM_BAKE_CANCELLED, 5)
};
/* clang-format on */

int main(void) {
    int failures = 0;
    size_t i;
    for (i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        if (rows[i].value == rows[i].expected) continue;
        printf("wrong: %s is %lld, not %lld\n", rows[i].name, (long long)rows[i].value, (long long)rows[i].expected);
        ++failures;
    }
    printf("%zu constants: %d failures\n", i, failures);
    return failures ? 1 : 0;
}
