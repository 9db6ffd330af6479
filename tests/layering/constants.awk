# constants.awk: named numbers that say nothing about where they come from: no comment on the line, nor on the line above.
function literal(text) { return text ~ /= *-?[0-9(]/ && text !~ /= *\(?[A-Za-z_]/ }
FNR == 1 { before = "" }
/constexpr [a-zA-Z_:0-9<> ]+ k[A-Z][A-Za-z0-9]* *=/ && $0 !~ /operator/ {
    if ($0 !~ /\/\// && before !~ /\/\// && literal($0)) print FILENAME ":" FNR ": " $0
}
{ before = $0 }
