// The trial store.
#pragma once
