#include "model/error.hpp"
#include "store/files.hpp"

#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

namespace jointcreep::store
{

std::string sha256_of(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
    if (!context || EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1)
        throw file_error(path + ": cannot compute its SHA-256");
    std::array<char, 1 << 16> buffer;
    errno = 0;
    while (file.read(buffer.data(), buffer.size()) || file.gcount() > 0)
        EVP_DigestUpdate(context.get(), buffer.data(), static_cast<std::size_t>(file.gcount()));
    if (!file.is_open() || file.bad() || !file.eof()) // a folder opens, but gives an error when read
        throw file_error(path + ": cannot read: " + std::strerror(errno));
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
    unsigned length = 0;
    EVP_DigestFinal_ex(context.get(), digest.data(), &length);
    std::string text;
    for (unsigned i = 0; i < length; ++i)
        for (const int digit : {digest[i] >> 4, digest[i] & 15})
            text += "0123456789abcdef"[digit];
    return text;
}

} // namespace jointcreep::store
