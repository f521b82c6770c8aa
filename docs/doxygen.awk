# What Doxygen is shown of a header. All but the presets and a few helpers is in namespace fpbm, which is left out of
# every name; what is said of it in a header is said of the header.

# Comments and the template line wait for what they belong to.
/^\/\/\// || /^template/ { held = held line($0); next }
sub(/^namespace fpbm::/, "namespace ") { }
/^namespace fpbm \{$/ { printf "%s", held ? "/// @file\n" held : ""; held = ""; next }
/^\}  \/\/ namespace fpbm$/ { next }

# What Eigen is told of a Scalar is not for users.
/^struct Eigen::/ { held = ""; skipping = 1 }
skipping { if (/^\};/) skipping = 0; next }

# A deduction guide looks like a function with the name of its class.
/^[A-Z][A-Za-z]*\(.*\) -> .*;$/ { held = ""; next }

{ printf "%s%s", held, line($0); held = "" }

# A formula on a line of its own stays on it.
function line(text) {
  if (match(text, /^ *\/\/\/   /)) text = substr(text, 1, RLENGTH) "@n " substr(text, RLENGTH + 1) " @n"
  return text "\n"
}
