#include <gmock/gmock.h>

#include "serve/mailbox.h"

namespace ragtop {
namespace {

using Kind = PageServer::MessageKind;
using testing::ElementsAre;
using testing::IsEmpty;

PageServer::Message take(Mailbox& mailbox) {
    PageServer::Message message;
    EXPECT_TRUE(mailbox.receive(message));
    return message;
}

Outgoing textOf(std::size_t bytes) {
    return {.kind = Outgoing::Kind::text, .text = std::string(bytes, 'x'), .frame = {}};
}
Outgoing frame() {
    return {.kind = Outgoing::Kind::frame, .text = {}, .frame = std::make_shared<const std::vector<std::byte>>(100)};
}

/// The kinds of what leaves for a client until nothing does.
std::string leaving(Mailbox& mailbox, ClientId client) {
    std::string kinds;
    while (const auto item = mailbox.next(client)) kinds += "tfp"[static_cast<int>(item->kind)];
    return kinds;
}

TEST(Mailbox, GivesMessagesInTheOrderTheyCame) {
    Mailbox mailbox({});
    const ClientId a = mailbox.join(), b = mailbox.join();
    EXPECT_TRUE(mailbox.say(b, "1"));
    EXPECT_TRUE(mailbox.say(a, "2"));
    mailbox.leave(b);
    EXPECT_EQ(take(mailbox).client, a);
    EXPECT_EQ(take(mailbox).client, b);
    EXPECT_THAT(mailbox.clients(), ElementsAre(a, b));
    EXPECT_EQ(take(mailbox).text, "1");
    EXPECT_EQ(take(mailbox).text, "2");
    EXPECT_THAT(mailbox.clients(), ElementsAre(a, b));
    EXPECT_EQ(take(mailbox).kind, Kind::left);
    EXPECT_THAT(mailbox.clients(), ElementsAre(a));
    PageServer::Message none;
    EXPECT_FALSE(mailbox.receive(none));
}

TEST(Mailbox, NumbersAreNeverUsedAgain) {
    Mailbox mailbox({});
    const ClientId first = mailbox.join();
    mailbox.leave(first);
    EXPECT_NE(mailbox.join(), first);
}

TEST(Mailbox, OnePageCannotFillItForAnother) {
    PageServerOptions limits;
    limits.unreadMessages = 3;
    Mailbox mailbox(limits);
    const ClientId flood = mailbox.join(), other = mailbox.join();
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(mailbox.say(flood, "x"));
    EXPECT_FALSE(mailbox.say(flood, "x"));
    EXPECT_TRUE(mailbox.say(other, "x"));
    for (int i = 0; i < 3; ++i) take(mailbox);
    EXPECT_TRUE(mailbox.say(flood, "x"));
}

TEST(Mailbox, BoundsTheBytesThatWait) {
    PageServerOptions limits;
    limits.unreadBytes = 100;
    Mailbox mailbox(limits);
    const ClientId client = mailbox.join();
    EXPECT_TRUE(mailbox.say(client, std::string(60, 'x')));
    EXPECT_FALSE(mailbox.say(client, std::string(41, 'x')));
    EXPECT_TRUE(mailbox.say(client, std::string(40, 'x')));
}

TEST(Mailbox, PagesThatComeAndGoDoNotGrowIt) {
    PageServerOptions limits;
    limits.clients = 2;
    limits.unreadMessages = 4;
    Mailbox mailbox(limits);
    int joined = 0;
    for (; mailbox.hasRoom() && joined < 100; ++joined) {
        const ClientId client = mailbox.join();
        EXPECT_TRUE(mailbox.say(client, "x") || joined > 1);
        mailbox.leave(client);
    }
    EXPECT_LE(joined, 4);
    while (!mailbox.hasRoom()) take(mailbox);
}

TEST(Mailbox, TextAndFramesLeaveInTheOrderSentAndAPingFollows) {
    Mailbox mailbox({});
    const ClientId client = mailbox.join();
    EXPECT_TRUE(mailbox.send(client, textOf(1)));
    EXPECT_FALSE(mailbox.send(client, frame())) << "it need be told only once";
    EXPECT_FALSE(mailbox.send(client, textOf(1)));
    EXPECT_EQ(leaving(mailbox, client), "tftp");
    EXPECT_EQ(leaving(mailbox, client), "");
    EXPECT_TRUE(mailbox.send(client, frame()));
    EXPECT_EQ(leaving(mailbox, client), "fp");
}

TEST(Mailbox, PageIsReadyWhenNoFrameWaits) {
    PageServerOptions limits;
    limits.lagSeconds = 1e9;
    Mailbox mailbox(limits);
    const ClientId client = mailbox.join();
    EXPECT_TRUE(mailbox.ready(client));
    EXPECT_TRUE(mailbox.send(client, frame()));
    EXPECT_FALSE(mailbox.ready(client));
    ASSERT_TRUE(mailbox.next(client));
    EXPECT_FALSE(mailbox.ready(client)) << "it is under way";
    ASSERT_TRUE(mailbox.next(client));
    EXPECT_TRUE(mailbox.ready(client));
    EXPECT_FALSE(mailbox.ready(client + 1));
}

TEST(Mailbox, PageIsReadyWhenItHasReadWhatWasSentLongAgo) {
    PageServerOptions limits;
    limits.lagSeconds = 0;
    Mailbox mailbox(limits);
    const ClientId client = mailbox.join();
    for (int i = 0; i < 2; ++i) {
        EXPECT_TRUE(mailbox.send(client, frame()));
        EXPECT_EQ(leaving(mailbox, client), "fp");
    }
    EXPECT_GT(mailbox.lag(client), 0);
    EXPECT_FALSE(mailbox.ready(client));
    mailbox.answered(client, 1);
    EXPECT_FALSE(mailbox.ready(client));
    for (const std::uint32_t wrong : {0u, 1u, 3u, 4000000000u}) mailbox.answered(client, wrong);
    EXPECT_FALSE(mailbox.ready(client));
    mailbox.answered(client, 2);
    EXPECT_EQ(mailbox.lag(client), 0);
    EXPECT_TRUE(mailbox.ready(client));
}

TEST(Mailbox, AnswerToTheLatestPingStandsForThoseBefore) {
    PageServerOptions limits;
    limits.lagSeconds = 0;
    Mailbox mailbox(limits);
    const ClientId client = mailbox.join();
    for (int i = 0; i < 1000; ++i) {
        (void)mailbox.send(client, frame());
        leaving(mailbox, client);
    }
    EXPECT_FALSE(mailbox.ready(client));
    mailbox.answered(client, 64);
    EXPECT_TRUE(mailbox.ready(client)) << "no more than 64 pings are unanswered at once";
}

TEST(Mailbox, PageThatLetsTooMuchPileUpGetsNoMore) {
    PageServerOptions limits;
    limits.unsentBytes = 1000;
    Mailbox mailbox(limits);
    const ClientId client = mailbox.join();
    EXPECT_TRUE(mailbox.send(client, textOf(600)));
    ASSERT_TRUE(mailbox.next(client));
    EXPECT_FALSE(mailbox.send(client, textOf(400)));
    EXPECT_FALSE(mailbox.overflown(client));
    EXPECT_TRUE(mailbox.send(client, textOf(1))) << "the network must be told to cut it off";
    EXPECT_TRUE(mailbox.overflown(client));
    EXPECT_FALSE(mailbox.ready(client));
    EXPECT_FALSE(mailbox.send(client, textOf(1)));
}

TEST(Mailbox, WhatIsSentToAPageThatIsGoneIsDropped) {
    Mailbox mailbox({});
    const ClientId client = mailbox.join();
    mailbox.leave(client);
    EXPECT_FALSE(mailbox.send(client, textOf(1)));
    EXPECT_FALSE(mailbox.ready(client));
}

}  // namespace
}  // namespace ragtop
