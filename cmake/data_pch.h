// SPDX-License-Identifier: Apache-2.0
// The precompiled header of all layers that know data: what nearly every file of them includes. A file still names what it uses.
#pragma once
#include "base/pch.h"

#include <atomic>
#include <bit>
#include <functional>
#include <map>
#include <mutex>
#include <type_traits>

#include "base/context.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
