#pragma once

#include <type_traits>
#include <utility>

namespace fpbm {

template <typename, template <typename...> class Member, typename... Arguments>
inline constexpr bool kHasMember = false;
template <template <typename...> class Member, typename... Arguments>
inline constexpr bool kHasMember<std::void_t<Member<Arguments...>>, Member, Arguments...> = true;

/// Whether a type has a member: Member<Type, Arguments…> is a type.
template <typename Type, template <typename...> class Member, typename... Arguments>
inline constexpr bool kHas = kHasMember<void, Member, Type, Arguments...>;

}  // namespace fpbm
