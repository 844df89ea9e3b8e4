// SPDX-License-Identifier: Apache-2.0
// The precompiled header of the tests.
#pragma once
#include "data_pch.h"
#include "support/test.h"
