// Does not compile: line 5.
#pragma once

float broken(float x) {
    return x + no_such_name;
}
