# Filters a header for Doxygen. Removes the namespace fpbm from all names. The comment on this namespace becomes the
# comment on the header.

# Comments and the template line are printed together with the declaration that follows.
/^\/\/\// || /^template/ { held = held line($0); next }
sub(/^namespace fpbm::/, "namespace ") { }
/^namespace fpbm \{$/ { printf "%s", held ? "/// @file\n" held : ""; held = ""; next }
/^\}  \/\/ namespace fpbm$/ { next }

# Specialisations of Eigen's templates for a Scalar are not for users.
/^struct Eigen::/ { held = ""; skipping = 1 }
skipping { if (/^\};/) skipping = 0; next }

# A deduction guide looks like a function with the name of its class.
/^[A-Z][A-Za-z]*\(.*\) -> .*;$/ { held = ""; next }

{ printf "%s%s", held, line($0); held = "" }

# A formula keeps its own line.
function line(text) {
  if (match(text, /^ *\/\/\/   /)) text = substr(text, 1, RLENGTH) "@n " substr(text, RLENGTH + 1) " @n"
  return text "\n"
}
